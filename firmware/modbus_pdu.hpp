// SPDX-License-Identifier: Apache-2.0
// Modbus application protocol (V1.1b3): a request without address and CRC in, a response out. Functions 3, 4, 6, 16.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace stillpoint::firmware {

enum class ModbusException : uint8_t {
  kNone = 0,
  kIllegalFunction = 1,
  kIllegalAddress = 2,
  kIllegalValue = 3,
  kDeviceBusy = 6,  // not allowed in this state
};

constexpr size_t kMaxPduBytes = 253;
constexpr uint32_t kMaxReadWords = 125;
constexpr uint32_t kMaxWriteWords = 123;

namespace modbus {

enum Function : uint8_t { kReadHolding = 3, kReadInput = 4, kWriteSingle = 6, kWriteMultiple = 16 };

constexpr uint16_t word_at(const uint8_t* bytes) { return static_cast<uint16_t>((uint32_t{bytes[0]} << 8) | bytes[1]); }

constexpr void put_word(uint8_t* bytes, uint32_t word) {
  bytes[0] = static_cast<uint8_t>(word >> 8);
  bytes[1] = static_cast<uint8_t>(word);
}

// What the protocol needs of `Registers`. Both check in the specification's order (all addresses, then all values, then
// the state) and do nothing at all unless they return kNone.
//   ModbusException read(uint16_t first, uint32_t count, uint16_t* words);
//   ModbusException write(uint16_t first, uint32_t count, const uint16_t* words);
//   ModbusException write_single(uint16_t address, uint16_t word);

template <typename Registers>
ModbusException read(Registers& registers, const uint8_t* request, size_t length, uint8_t* response, size_t& written) {
  if (length != 5) return ModbusException::kIllegalValue;
  const uint32_t count = word_at(request + 3);
  if (count < 1 || count > kMaxReadWords) return ModbusException::kIllegalValue;
  uint16_t words[kMaxReadWords];
  const ModbusException refused = registers.read(word_at(request + 1), count, words);
  if (refused != ModbusException::kNone) return refused;
  response[1] = static_cast<uint8_t>(2 * count);
  for (uint32_t i = 0; i < count; ++i) put_word(response + 2 + 2 * i, words[i]);
  written = 2 + 2 * count;
  return ModbusException::kNone;
}

template <typename Registers>
ModbusException write_single(Registers& registers, const uint8_t* request, size_t length, uint8_t* response,
                             size_t& written) {
  if (length != 5) return ModbusException::kIllegalValue;
  const ModbusException refused = registers.write_single(word_at(request + 1), word_at(request + 3));
  if (refused != ModbusException::kNone) return refused;
  for (size_t i = 1; i < 5; ++i) response[i] = request[i];
  written = 5;
  return ModbusException::kNone;
}

template <typename Registers>
ModbusException write_multiple(Registers& registers, const uint8_t* request, size_t length, uint8_t* response,
                               size_t& written) {
  if (length < 6) return ModbusException::kIllegalValue;
  const uint32_t count = word_at(request + 3);
  if (count < 1 || count > kMaxWriteWords) return ModbusException::kIllegalValue;
  if (request[5] != 2 * count || length != 6 + 2 * count) return ModbusException::kIllegalValue;
  uint16_t words[kMaxWriteWords];
  for (uint32_t i = 0; i < count; ++i) words[i] = word_at(request + 6 + 2 * i);
  const ModbusException refused = registers.write(word_at(request + 1), count, words);
  if (refused != ModbusException::kNone) return refused;
  for (size_t i = 1; i < 5; ++i) response[i] = request[i];
  written = 5;
  return ModbusException::kNone;
}

// Executes the request of `length` >= 1 bytes and writes the response, an exception where it is refused; returns its
// length. `response` has room for kMaxPduBytes and is not the request. Background.
template <typename Registers>
size_t execute(Registers& registers, const uint8_t* request, size_t length, uint8_t* response) {
  ModbusException refused = ModbusException::kIllegalFunction;
  size_t written = 0;
  switch (request[0]) {
    case kReadHolding:
    case kReadInput: refused = read(registers, request, length, response, written); break;
    case kWriteSingle: refused = write_single(registers, request, length, response, written); break;
    case kWriteMultiple: refused = write_multiple(registers, request, length, response, written); break;
    default: break;
  }
  response[0] = request[0];
  if (refused == ModbusException::kNone) return written;
  response[0] = static_cast<uint8_t>(request[0] | 0x80U);
  response[1] = static_cast<uint8_t>(refused);
  return 2;
}

}  // namespace modbus
}  // namespace stillpoint::firmware
