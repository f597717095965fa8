// SPDX-License-Identifier: Apache-2.0
// The states, values, faults, refusals and keys of the drive, from the firmware's own functions and the words of
// sim/hil.
#include "sim/cli/register_guide.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "firmware/parameter_keeper.hpp"
#include "firmware/parameter_store.hpp"
#include "firmware/register_bank.hpp"
#include "firmware/state_machine.hpp"
#include "sim/cli/drive_state.hpp"
#include "sim/cli/drive_texts.hpp"
#include "sim/cli/json.hpp"
#include "sim/hil/register_texts.hpp"
#include "sim/hil/value_texts.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::CommandKey;
using firmware::DriveCommand;
using firmware::DriveState;
using firmware::FaultCode;
using firmware::Parameter;

constexpr uint32_t kAllWords = 0x10000;
constexpr uint32_t kDriveReasons = 0x8000;  // from here on the drive's own, below the shaper's

// Whether it can have the value at all.
bool may_be(const Parameter& parameter, uint32_t value) {
  uint32_t accepted = 0;
  return !parameter.writable() || in_range(parameter, parameter.maximum, value, accepted);
}

std::vector<std::pair<uint32_t, std::string>> worded_values(const Parameter& parameter) {
  std::vector<std::pair<uint32_t, std::string>> values;
  for (uint32_t value = 0; value <= UINT8_MAX; ++value) {
    const char* const text = sim::value_text(parameter.name, value);
    if (text != nullptr && may_be(parameter, value)) values.emplace_back(value, text);
  }
  return values;
}

// "x110": bits 3 to 0 of the controlwords that ask for it.
std::string pattern_of(DriveCommand command) {
  uint32_t always = 0xF;
  uint32_t never = 0xF;
  for (uint32_t bits = 0; bits <= 0xF; ++bits) {
    if (firmware::command_of(static_cast<uint16_t>(bits)) != command) continue;
    always &= bits;
    never &= ~bits;
  }
  std::string pattern;
  for (uint32_t mask = 8; mask != 0; mask /= 2) pattern += (always & mask) != 0 ? "1" : (never & mask) != 0 ? "0" : "x";
  return pattern;
}

void print_bits(const char* heading, const char* (*text)(uint32_t mask)) {
  fmt::print("\n| bit | {} |\n|---|---|\n", heading);
  for (uint32_t bit = 0; bit < 16; ++bit) {
    const char* const words = text(UINT32_C(1) << bit);
    if (words != nullptr) fmt::print("| {} | {} |\n", bit, words);
  }
}

// The registers that `belongs` picks: "0020, 0021".
template <typename Belongs>
std::string list_of(const Belongs& belongs) {
  std::string list;
  for (const Parameter parameter : firmware::kParameters) {
    if (belongs(parameter)) list += fmt::format("{}{:04X}", list.empty() ? "" : ", ", address_of(parameter.name));
  }
  return list;
}

}  // namespace

std::string values_of(const Parameter& parameter) {
  std::string all;
  for (const auto& [value, text] : worded_values(parameter)) {
    all += fmt::format("{}{} {}", all.empty() ? "" : "; ", value, text);
  }
  return all;
}

Json values_json(const Parameter& parameter) {
  Json all = Json::array();
  for (const auto& [value, text] : worded_values(parameter)) all.push_back({{"value", value}, {"text", text}});
  return all;
}

std::map<uint16_t, std::string> faults() {
  const std::string unknown = text_of_fault(UINT16_MAX);
  std::map<uint16_t, std::string> all;
  for (uint32_t code = 1; code < UINT16_MAX; ++code) {
    const std::string text = text_of_fault(static_cast<uint16_t>(code));
    if (text != unknown) all[static_cast<uint16_t>(code)] = text;
  }
  return all;
}

std::map<uint16_t, std::string> drive_reasons() {
  std::map<uint16_t, std::string> all;
  for (uint32_t reason = kDriveReasons; reason <= UINT16_MAX; ++reason) {
    const std::string text = text_of_reason(static_cast<uint16_t>(reason));
    if (text.find("not known") == std::string::npos) all[static_cast<uint16_t>(reason)] = text;
  }
  return all;
}

void print_states() {
  std::vector<DriveCommand> commands;
  for (uint32_t k = 0; sim::text(static_cast<DriveCommand>(k)) != nullptr; ++k)
    commands.push_back(static_cast<DriveCommand>(k));
  fmt::print(R"(
## States, controlword, statusword

Bits 0 to 3 of the controlword (0040) are a level: what they ask for is asked for as long as they stand. Below, what
they are for each command, and where that leads from each state. Bits 0 to 3, 5 and 6 of the statusword (0041) are the
state.

| state | 0041 & 006F |)");
  for (const DriveCommand command : commands) fmt::print(" {} {} |", sim::text(command), pattern_of(command));
  fmt::print("\n|---|---|");
  for (size_t k = 0; k < commands.size(); ++k) fmt::print("---|");
  fmt::print("\n");
  for (uint32_t k = 0; *text(static_cast<DriveState>(k)) != '\0'; ++k) {
    const auto state = static_cast<DriveState>(k);
    fmt::print("| {} | {:04X} |", text(state), firmware::status_bits(state));
    for (const DriveCommand command : commands) {
      const DriveState next = next_state(state, command);
      fmt::print(" {} |", next == state ? "" : text(next));
    }
    fmt::print("\n");
  }
  fmt::print(R"(
Enable operation takes a ready drive through switched on. It waits for valid feedback, begins at the actual position
and with target velocity 0, and never starts a motion. From operation enabled, switch on ramps by the profile's limits
first; shutdown and disable voltage switch off at once, whatever moves. Quick stop is what 0078 says; where that stays,
enable operation goes on once the axis stands, else it ends in switch on disabled. Another mode (0042) is in force, and
in 0043, once the axis stands. What is asked for while a commanded stop is under way is lost; enable operation during a
switch on's ramp keeps the drive on, standing. 0052 reads 0 after every stop but a halt.

Beyond a soft limit (pushed there while off, the limit drawn in) a drive can be enabled and moves inwards; targets and
velocities further out are refused.

A set-point: write 0044 on, raise bit 4, wait until bit 12 of the statusword is up or 0012 is not 0 (the edge clears
it), lower bit 4. Lowered before, the set-point may be lost. Behind one that is kept another is refused, but for one at
once, which replaces both. A velocity needs no bit 4: what is written to 0052 while enabled is followed. A shaper on its
way (0131: 2) is waited for.
)");
  print_bits("controlword", sim::control_text);
  print_bits("statusword", sim::status_text);
}

void print_values() {
  std::vector<std::pair<std::string, std::string>> rows;  // values, registers: those that are alike in one row
  for (const Parameter parameter : firmware::kParameters) {
    const std::string values = values_of(parameter);
    const std::string address = fmt::format("{:04X}", address_of(parameter.name));
    if (values.empty()) continue;
    size_t row = 0;
    while (row < rows.size() && rows[row].first != values) ++row;
    if (row == rows.size()) {
      rows.emplace_back(values, address);
    } else {
      rows[row].second += ", " + address;
    }
  }
  fmt::print("\n## Values\n\n| registers | values |\n|---|---|\n");
  for (const auto& [values, registers] : rows) fmt::print("| {} | {} |\n", registers, values);
  print_bits("warnings (0011)", sim::warning_text);
}

void print_faults() {
  fmt::print(R"(
## Faults

In 0010 and the fault history. The first one latches. 0079: as that says, and then off; until then the state is fault
reaction active, then fault. Nothing new starts meanwhile. Edge: bit 7 of the controlword rising in fault leads to
switch on disabled; an edge before that is lost. A fault that still is there comes back when enabled.

| code | fault | seen | reaction | reset |
|---|---|---|---|---|
)");
  for (const auto& [code, text] : faults()) {
    const sim::FaultText more = sim::fault_text(static_cast<FaultCode>(code));
    fmt::print("| {:04X} | {} | {} | {} | {} |\n", code, text, more.seen, more.reaction, more.reset);
  }
}

void print_refusals() {
  fmt::print(R"(
## Refusals

A request refused with exception 06, or with 03 for a value out of its range, leaves the reason in 0012, the register
in 0013, and in 0016 what would have been accepted there, in that register's unit (0: nothing). So does, without an
exception, what is refused later: a set-point, a shaper (0132 too; one of the tracking's in 0251 alone), a command key
(0015: 3), a tuning that the axis ended, and at the start what was stored and could not be loaded. What was in force
still is.

| reason | |
|---|---|
)");
  for (const auto& [reason, text] : drive_reasons()) fmt::print("| {:04X} | {} |\n", reason, text);
  const uint16_t example = firmware::reason_of(Error::kBelowMinimum, Quantity::kFrequency);
  fmt::print("\nBelow {:04X} the high byte says what is wrong, the low byte with what ({:04X}: {}).\n", kDriveReasons,
             example, text_of_reason(example));
  fmt::print("\n| high byte | |\n|---|---|\n");
  const std::string no_error = text(static_cast<Error>(UINT8_MAX));
  for (uint32_t value = 1; text(static_cast<Error>(value)) != no_error; ++value) {
    fmt::print("| {:02X} | {} |\n", value, text(static_cast<Error>(value)));
  }
  fmt::print("\n| low byte | |\n|---|---|\n");
  const std::string no_quantity = text(static_cast<Quantity>(UINT8_MAX));
  for (uint32_t value = 0; text(static_cast<Quantity>(value)) != no_quantity; ++value) {
    fmt::print("| {:02X} | {} |\n", value, text(static_cast<Quantity>(value)));
  }
}

void print_keys() {
  fmt::print("\n## Keys\n\n| 0014 | |\n|---|---|\n");
  for (uint32_t value = 0; value < kAllWords; ++value) {
    const auto key = static_cast<CommandKey>(value);
    if (sim::text(key) != nullptr) fmt::print("| {:04X} | {} |\n", value, sim::text(key));
  }
  fmt::print(R"(
Unlock opens, for {} s from its last writing, the other keys and the registers marked L:
{}.

The other keys are accepted in switch on disabled, ready to switch on and fault. They begin {} ms later, so that the
answer is out; 0015 is 1 until then, and then 2 or 3. Saved is every RW register and all shaper sets (0100 on), with the
shaper in force; but for {}.
)",
             firmware::kUnlockedMs / 1000,
             list_of([](const Parameter& parameter) { return parameter.lock == firmware::Lock::kNeedsKey; }),
             firmware::ParameterKeeper::kCommandDelayMs, list_of([](const Parameter& parameter) {
               const bool reserved = parameter.minimum == parameter.maximum;
               return parameter.readable() && parameter.writable() && !stored(parameter) && !reserved;
             }));
}

}  // namespace stillpoint::cli
