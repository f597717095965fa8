// SPDX-License-Identifier: Apache-2.0
#include "firmware/modbus_server.hpp"

#include "firmware/modbus_identification.hpp"

namespace stillpoint::firmware {

using modbus::Exchange;
using modbus::word_at;

namespace {

// The response to a read.
void put_registers(Exchange& exchange, uint32_t count) {
  exchange.response[0] = exchange.request[0];
  exchange.response[1] = static_cast<uint8_t>(2 * count);
  for (uint32_t i = 0; i < count; ++i) modbus::put_word(exchange.response + 2 + 2 * i, exchange.words[i]);
  exchange.written = 2 + 2 * count;
}

}  // namespace

bool ModbusServer::serve(RtuPort& line) {
  Exchange exchange = {line.request(), line.request_length(), line.response(), 0, {}};
  to_all_ = line.broadcast();
  const bool acts = !diagnostics_.listen_only() || modbus::Diagnostics::restarts(exchange);
  const ModbusException refused = acts ? execute(line, exchange) : ModbusException::kNone;
  if (refused != ModbusException::kNone) {
    exchange.response[0] = static_cast<uint8_t>(exchange.request[0] | modbus::kExceptionBit);
    exchange.response[1] = static_cast<uint8_t>(refused);
    exchange.written = 2;
  }
  line.reply(exchange.written);
  return acts;
}

ModbusException ModbusServer::execute(const RtuPort& line, Exchange& exchange) {
  switch (exchange.request[0]) {
    case modbus::kReadHolding:
    case modbus::kReadInput: return read(exchange);
    case modbus::kWriteSingle: return write_single(exchange);
    case modbus::kDiagnostics: return diagnose(line, exchange);
    case modbus::kWriteMultiple: return write_multiple(exchange);
    case modbus::kMaskWrite: return mask_write(exchange);
    case modbus::kReadWriteMultiple: return read_write(exchange);
    case modbus::kEncapsulated: return modbus::read_device_identification(exchange);
    default: return ModbusException::kIllegalFunction;
  }
}

// An axis that nobody can stop does not run on: it listens only while the drive is disabled.
ModbusException ModbusServer::diagnose(const RtuPort& line, Exchange& exchange) {
  const ModbusException refused = diagnostics_.execute(line.counters(), exchange);
  if (!diagnostics_.listen_only()) return refused;
  const ModbusException enabled = registers_->check_disabled();
  if (enabled != ModbusException::kNone) diagnostics_.answer_again();
  return enabled;
}

ModbusException ModbusServer::write(uint16_t first, uint32_t count, const uint8_t* bytes, uint16_t* words) {
  for (uint32_t i = 0; i < count; ++i) words[i] = word_at(bytes + 2 * i);
  return to_all_ ? registers_->write_from_all(first, count, words) : registers_->write(first, count, words);
}

ModbusException ModbusServer::read(Exchange& exchange) {
  if (exchange.length != 5) return ModbusException::kIllegalValue;
  const uint32_t count = word_at(exchange.request + 3);
  if (count < 1 || count > kMaxReadWords) return ModbusException::kIllegalValue;
  const ModbusException refused = registers_->read(word_at(exchange.request + 1), count, exchange.words);
  if (refused == ModbusException::kNone) put_registers(exchange, count);
  return refused;
}

ModbusException ModbusServer::write_single(Exchange& exchange) {
  if (exchange.length != 5) return ModbusException::kIllegalValue;
  const ModbusException refused = write(word_at(exchange.request + 1), 1, exchange.request + 3, exchange.words);
  return refused == ModbusException::kNone ? modbus::echo(exchange, 5) : refused;
}

ModbusException ModbusServer::write_multiple(Exchange& exchange) {
  const uint8_t* request = exchange.request;
  if (exchange.length < 6) return ModbusException::kIllegalValue;
  const uint32_t count = word_at(request + 3);
  if (count < 1 || count > kMaxWriteWords) return ModbusException::kIllegalValue;
  if (request[5] != 2 * count || exchange.length != 6 + 2 * count) return ModbusException::kIllegalValue;
  const ModbusException refused = write(word_at(request + 1), count, request + 6, exchange.words);
  return refused == ModbusException::kNone ? modbus::echo(exchange, 5) : refused;
}

ModbusException ModbusServer::mask_write(Exchange& exchange) {
  if (exchange.length != 7) return ModbusException::kIllegalValue;
  const uint16_t address = word_at(exchange.request + 1);
  const uint32_t kept = word_at(exchange.request + 3);
  const uint32_t set = word_at(exchange.request + 5);
  ModbusException refused = registers_->read(address, 1, exchange.words);
  if (refused != ModbusException::kNone) return refused;
  uint8_t bytes[2];
  modbus::put_word(bytes, (exchange.words[0] & kept) | (set & ~kept));
  refused = write(address, 1, bytes, exchange.words);
  return refused == ModbusException::kNone ? modbus::echo(exchange, 7) : refused;
}

ModbusException ModbusServer::read_write(Exchange& exchange) {
  const uint8_t* request = exchange.request;
  if (exchange.length < 10) return ModbusException::kIllegalValue;
  const uint16_t first = word_at(request + 1);
  const uint32_t count = word_at(request + 3);
  const uint32_t written = word_at(request + 7);
  if (count < 1 || count > kMaxReadWords || written < 1 || written > kMaxReadWriteWords) {
    return ModbusException::kIllegalValue;
  }
  if (request[9] != 2 * written || exchange.length != 10 + 2 * written) return ModbusException::kIllegalValue;
  // Once to know that it can be read, before anything is written; what is written may not change that.
  ModbusException refused = registers_->read(first, count, exchange.words);
  registers_->keep_record(first / 256 == kFirstScopeWord / 256);
  if (refused == ModbusException::kNone) refused = write(word_at(request + 5), written, request + 10, exchange.words);
  registers_->keep_record(false);
  if (refused == ModbusException::kNone) refused = registers_->read(first, count, exchange.words);
  if (refused == ModbusException::kNone) put_registers(exchange, count);
  return refused;
}

}  // namespace stillpoint::firmware
