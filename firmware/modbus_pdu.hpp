// SPDX-License-Identifier: Apache-2.0
// Modbus application protocol (V1.1b3): what requests and responses are made of, without address and CRC.
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
constexpr uint32_t kMaxReadWriteWords = 121;  // of function 23, the written ones

namespace modbus {

enum Function : uint8_t {
  kReadHolding = 3,
  kReadInput = 4,
  kWriteSingle = 6,
  kDiagnostics = 8,
  kWriteMultiple = 16,
  kMaskWrite = 22,
  kReadWriteMultiple = 23,
  kEncapsulated = 43,
};

constexpr uint8_t kExceptionBit = 0x80;

// A request, the response to it as it grows, and room for registers on their way. `response` is not the request and has
// room for kMaxPduBytes.
struct Exchange {
  const uint8_t* request;
  size_t length;  // at least 1
  uint8_t* response;
  size_t written;  // of the response
  uint16_t words[kMaxReadWords];
};

constexpr uint16_t word_at(const uint8_t* bytes) { return static_cast<uint16_t>((uint32_t{bytes[0]} << 8) | bytes[1]); }

constexpr void put_word(uint8_t* bytes, uint32_t word) {
  bytes[0] = static_cast<uint8_t>(word >> 8);
  bytes[1] = static_cast<uint8_t>(word);
}

// A response that repeats the first `bytes` of the request.
inline ModbusException echo(Exchange& exchange, size_t bytes) {
  for (size_t i = 0; i < bytes; ++i) exchange.response[i] = exchange.request[i];
  exchange.written = bytes;
  return ModbusException::kNone;
}

}  // namespace modbus
}  // namespace stillpoint::firmware
