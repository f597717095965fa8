// SPDX-License-Identifier: Apache-2.0
// `stillpoint registers`: the drive's register map as the firmware's own table has it, for people and for programs.
#include <fmt/format.h>

#include <map>
#include <string>
#include <utility>

#include "firmware/parameters.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/drive_registers.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/register_guide.hpp"

namespace stillpoint::cli {
namespace {

using firmware::Access;
using firmware::Parameter;
using firmware::Type;

const char* type_text(Type type) {
  switch (type) {
    case Type::kU16: return "u16";
    case Type::kI16: return "i16";
    case Type::kU32: return "u32";
    case Type::kI32: return "i32";
  }
  return "";
}

std::string access_text(const Parameter& parameter) {
  const char* const text = parameter.access == Access::kRead ? "R" : parameter.access == Access::kWrite ? "W" : "RW";
  return parameter.lock == firmware::Lock::kNeedsKey ? std::string(text) + " L" : text;
}

int64_t number(const Parameter& parameter, uint32_t bits) {
  return parameter.is_signed() ? static_cast<int64_t>(static_cast<int32_t>(bits)) : static_cast<int64_t>(bits);
}

// "0-3", "0-1, 3" where not all between are available, or the register that bounds it.
std::string range_text(const Parameter& parameter) {
  if (!parameter.writable()) return "";
  const int64_t low = number(parameter, parameter.minimum);
  if (parameter.ceiling != firmware::kNoRegister) {
    return fmt::format("{} to {:04X}", low, firmware::address_of(parameter.ceiling));
  }
  if (parameter.unused_or_more()) return fmt::format("0, {} to {}", parameter.allowed, parameter.maximum);
  if (parameter.allowed == 0) return fmt::format("{} to {}", low, number(parameter, parameter.maximum));
  std::string text;
  for (uint32_t bit = 0; bit < 32; ++bit) {
    if ((parameter.allowed >> bit & 1U) != 0) text += fmt::format("{}{}", text.empty() ? "" : ", ", low + bit);
  }
  return text;
}

std::string object_text(const Parameter& parameter) {
  return firmware::text_of(parameter).object == 0 ? "" : fmt::format("{:04X}", firmware::text_of(parameter).object);
}

Json json_of(const Parameter& parameter) {
  Json object = {{"address", firmware::address_of(parameter.name)},
                 {"name", name_of(parameter)},
                 {"text", firmware::text_of(parameter).text},
                 {"type", type_text(parameter.type)},
                 {"unit", firmware::text_of(parameter).unit},
                 {"access", access_text(parameter)},
                 {"range", range_text(parameter)},
                 {"default", number(parameter, parameter.initial)}};
  if (firmware::text_of(parameter).object != 0) object["object"] = object_text(parameter);
  Json values = values_json(parameter);
  if (!values.empty()) object["values"] = std::move(values);
  return object;
}

Json json_of(const std::map<uint16_t, std::string>& texts) {
  Json all = Json::array();
  for (const auto& [value, text] : texts) all.push_back({{"value", value}, {"text", text}});
  return all;
}

constexpr char kHead[] =
    R"(# The drive's registers

Printed by `stillpoint registers` from the firmware's own table. Modbus RTU, addresses from 0, hexadecimal; a 32-bit
value takes two registers, the high word first, and is written whole. L: needs the unlock key (Keys, below). A range
that ends with an address ends with that register's value. CiA: the object of CiA 402. Below the table: requests, states
and their words, values, faults, refusals, keys, windows, diagnostics.

| address | name | type | unit | range | access | default | CiA | |
|---|---|---|---|---|---|---|---|---|
)";

int run(const Output& output) {
  if (output.json) {
    Json all = Json::array();
    for (const Parameter parameter : firmware::kParameters) all.push_back(json_of(parameter));
    print_json(
        {{"result", "ok"}, {"registers", all}, {"faults", json_of(faults())}, {"reasons", json_of(drive_reasons())}});
    return 0;
  }
  fmt::print("{}", kHead);
  for (const Parameter parameter : firmware::kParameters) {
    fmt::print("| {:04X} | {} | {} | {} | {} | {} | {} | {} | {} |\n", firmware::address_of(parameter.name),
               name_of(parameter), type_text(parameter.type), firmware::text_of(parameter).unit, range_text(parameter),
               access_text(parameter), number(parameter, parameter.initial), object_text(parameter),
               firmware::text_of(parameter).text);
  }
  print_requests();
  print_states();
  print_values();
  print_faults();
  print_refusals();
  print_keys();
  print_windows();
  print_serial_line();
  return 0;
}

}  // namespace

void add_registers(Commands& commands, Output& output) {
  CLI::App& app = commands.add("registers", "The drive's register map, from the firmware's own table.",
                               [&output] { return run(output); });
  add_json(app, output);
}

}  // namespace stillpoint::cli
