// SPDX-License-Identifier: Apache-2.0
// What of the drive's Modbus is no parameter: requests, windows, broadcasts, diagnostics, identification.
#include <fmt/format.h>

#include <stdexcept>

#include "firmware/fault_log.hpp"
#include "firmware/modbus_diagnostics.hpp"
#include "firmware/modbus_identification.hpp"
#include "firmware/modbus_pdu.hpp"
#include "firmware/position_stream.hpp"
#include "shaper/tune/auto_tune.hpp"
#include "sim/cli/register_guide.hpp"
#include "sim/hil/register_texts.hpp"
#include "sim/hil/value_texts.hpp"

namespace stillpoint::cli {
namespace {

using firmware::ModbusException;
using firmware::modbus::Exchange;

void put(uint8_t* to, uint32_t word) { firmware::modbus::put_word(to, word); }

const char* diagnostic_text(uint32_t sub_function) {
  switch (sub_function) {
    case 0: return "return the query";
    case 1: return "restart the communication: ends listen-only, clears the counters";
    case 4:
      return "listen only, while disabled as for a save (06 else): nothing is executed or answered until function 8/1";
    case 10: return "clear the counters";
    case 11: return "whole messages on the line";
    case 12: return "messages with a bad CRC, too short or too long";
    case 13: return "exceptions";
    case 14: return "messages for this unit or for all";
    case 15: return "of those without an answer: broadcasts, listen-only";
    case 16: return "negative acknowledgements: 0";
    case 17: return "exceptions 06";
    case 18: return "messages too long to be kept";
    default: throw std::logic_error(fmt::format("diagnostics {} has no words here", sub_function));
  }
}

// As the firmware answers; the words are for what it knows.
std::string diagnostics() {
  std::string rows;
  for (uint32_t sub = 0; sub <= UINT16_MAX; ++sub) {
    uint8_t request[5] = {firmware::modbus::kDiagnostics};
    uint8_t response[firmware::kMaxPduBytes];
    put(request + 1, sub);
    Exchange exchange = {request, sizeof request, response, 0, {}};
    firmware::modbus::Diagnostics asked;
    if (asked.execute({}, exchange) == ModbusException::kIllegalFunction) continue;
    rows += fmt::format("| {} | {} |\n", sub, diagnostic_text(sub));
  }
  return rows;
}

std::string identification() {
  constexpr uint8_t kAllObjects[] = {firmware::modbus::kEncapsulated, 14, 3, 0};
  constexpr size_t kHeader = 7;
  uint8_t response[firmware::kMaxPduBytes];
  Exchange exchange = {kAllObjects, sizeof kAllObjects, response, 0, {}};
  if (firmware::modbus::read_device_identification(exchange) != ModbusException::kNone)
    throw std::logic_error("the identification is refused");
  std::string rows;
  for (size_t at = kHeader; at < exchange.written; at += 2U + response[at + 1]) {
    const std::string text(response + at + 2, response + at + 2 + response[at + 1]);
    rows += fmt::format("| {} | {} |\n", response[at], text);
  }
  return rows;
}

std::string scope_words() {
  std::string words;
  for (uint32_t k = 0; sim::text(static_cast<AxisPhase>(k)) != nullptr; ++k)
    words += fmt::format("{}{} {}", words.empty() ? "Phase: " : "; ", k, sim::text(static_cast<AxisPhase>(k)));
  words += ".\nFlags: ";
  bool first = true;
  for (uint32_t mask = 1; mask <= UINT16_MAX; mask *= 2) {
    if (sim::scope_flag_text(mask) == nullptr) continue;
    words += fmt::format("{}{:04X} {}", first ? "" : "; ", mask, sim::scope_flag_text(mask));
    first = false;
  }
  return words + ".";
}

}  // namespace

void print_requests() {
  fmt::print(R"(
## Requests

Functions 3, 4 (the same registers), 6, 16, 22, 23, 8 and 43/14; at most {} registers read, {} written, {} with
function 23, which writes before it reads, and writes nothing where it could not read. An exception is the first of: 01
function; 03 quantity or length; 02 an address that is not there, or is read-only and written; 03 a value, or half of a
32-bit register written; 06 lock or state. Each is checked over the whole request before the next, and all before
anything is done: a request is done whole or not at all, in the order of addresses, but for 0101, which goes first.
Write-only registers read 0. What one request reads is of one tick. Reading sets nothing off.

A broadcast (unit 0) is not answered. It can stop a motion and never start one: its controlword may not have bit 4, nor
ask for enable operation but in operation enabled with halt, where no other register may be written. It is refused else
({:04X}).
)",
             firmware::kMaxReadWords, firmware::kMaxWriteWords, firmware::kMaxReadWriteWords,
             firmware::kReasonBroadcast);
}

void print_windows() {
  using firmware::kFaultEntries;
  using firmware::kFaultEntryStride;
  using firmware::kFirstFaultEntry;
  using firmware::kFirstScopeWord;
  using firmware::kFirstStreamPosition;
  fmt::print(R"(
## Windows

| address | what | access |
|---|---|---|
| {:04X}-{:04X} | the next positions of a stream, i32 counts, by function 16 from {:04X} on | W |
| {:04X}-{:04X} | the page that 0311 names of the scope, {} samples i32 of a channel; 06 until its record is full | R |
| {:04X}-{:04X} | the newest {} faults, {} registers each | R |
)",
             kFirstStreamPosition, kFirstStreamPosition + 2 * firmware::kStreamWindow - 1, kFirstStreamPosition,
             kFirstScopeWord, kFirstScopeWord + 2 * firmware::kScopePage - 1, firmware::kScopePage, kFirstFaultEntry,
             kFirstFaultEntry + kFaultEntries * kFaultEntryStride - 1, kFaultEntries, kFaultEntryStride);
  fmt::print(R"(
A fault, the newest at {:04X}: +0 code; +1 how often this code has come; +2 uptime u32 ms; +4 position i32; +6 setpoint
i32 counts, both at the fault; then zeros, as everything is where there is none. It outlasts a restart, not a loss of
power.

The stream holds {} positions, 0088 ticks apart, each at most {} counts from the one before. Those of a request are
all taken or none (06: no room; 03: too far apart). Its first is where the axis stands; bit 4 of the controlword
begins it. Enabling and another mode in force empty it. With 0088 at 1 positions go out as they are, else a cubic
B-spline goes by them, two intervals late.

The scope has {} samples, shared by the channels of 030A on that come before the first 0. 0311: high byte the channel
from 0, low byte the page; samples rise in time, 0310 of each channel, 0309 of them before the trigger.
{}
)",
             kFirstFaultEntry, firmware::kStreamPositions, firmware::kMostStreamStep, TuneMemory::kSamples,
             scope_words());
}

void print_serial_line() {
  fmt::print("\n## Diagnostics (function 8) and identification (43/14)\n\n");
  fmt::print("| sub-function | |\n|---|---|\n{}\n| object | |\n|---|---|\n{}", diagnostics(), identification());
}

}  // namespace stillpoint::cli
