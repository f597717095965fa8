// SPDX-License-Identifier: Apache-2.0
#include "firmware/modbus_diagnostics.hpp"

namespace stillpoint::firmware::modbus {
namespace {

enum SubFunction : uint16_t {
  kReturnQuery = 0,
  kRestart = 1,
  kForceListenOnly = 4,
  kClearCounters = 10,
  kFirstCounter = 11,
};

constexpr uint16_t kClearLog = 0xFF00;  // of a restart; there is no event log

}  // namespace

bool Diagnostics::restarts(const Exchange& exchange) {
  const uint8_t* request = exchange.request;
  if (exchange.length != 5 || request[0] != kDiagnostics || word_at(request + 1) != kRestart) return false;
  return word_at(request + 3) == 0 || word_at(request + 3) == kClearLog;
}

ModbusException Diagnostics::execute(const RtuCounters& line, Exchange& exchange) {
  if (exchange.length < 3) return ModbusException::kIllegalValue;
  const uint32_t sub = word_at(exchange.request + 1);
  const bool counter = sub >= kFirstCounter && sub < kFirstCounter + kCounters;
  if (!counter && sub != kReturnQuery && sub != kRestart && sub != kForceListenOnly && sub != kClearCounters) {
    return ModbusException::kIllegalFunction;
  }
  if (sub == kReturnQuery) {
    const bool words = exchange.length >= 5 && exchange.length % 2 == 1;
    return words ? echo(exchange, exchange.length) : ModbusException::kIllegalValue;
  }
  if (sub == kRestart ? !restarts(exchange) : exchange.length != 5 || word_at(exchange.request + 3) != 0) {
    return ModbusException::kIllegalValue;
  }
  echo(exchange, exchange.length);
  if (counter) {
    const uint32_t index = sub - kFirstCounter;
    put_word(exchange.response + 3, raw(line, index) - cleared_at_[index]);
    return ModbusException::kNone;
  }
  if (sub == kForceListenOnly || listen_only_) exchange.written = 0;
  listen_only_ = sub == kForceListenOnly;
  if (!listen_only_) clear(line);
  return ModbusException::kNone;
}

// Each as the serial line guide names it. Frames too short or too long for a CRC count as errors of it.
uint32_t Diagnostics::raw(const RtuCounters& line, uint32_t index) {
  switch (index) {
    case 0: return line.requests + line.others;                   // bus messages
    case 1: return line.crc_errors + line.runts + line.oversize;  // communication errors
    case 2: return line.exceptions;
    case 3: return line.requests;
    case 4: return line.unanswered;
    case 6: return line.busy;
    case 7: return line.oversize;  // character overruns: more came than can be kept
    default: return 0;             // negative acknowledgements: never given
  }
}

void Diagnostics::clear(const RtuCounters& line) {
  for (uint32_t i = 0; i < kCounters; ++i) cleared_at_[i] = raw(line, i);
}

}  // namespace stillpoint::firmware::modbus
