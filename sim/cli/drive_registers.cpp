// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_registers.hpp"

#include <fmt/format.h>

#include <cctype>
#include <map>

#include "sim/cli/chip_client.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Parameter;
using firmware::Register;

// The number of the mode whose block it is in, or -1.
int mode_of(const Parameter& parameter) {
  const uint32_t first = address_of(Register::kFirstMode);
  const uint32_t address = address_of(parameter.name);
  if (address < first || address >= first + firmware::kModeStride * firmware::kMaxModes) return -1;
  return static_cast<int>((address - first) / firmware::kModeStride);
}

std::string plain_name(const Parameter& parameter) {
  std::string name;
  for (const char* at = firmware::text_of(parameter).text; *at != 0 && *at != '('; ++at) {
    // What may be written to a command comes after its name.
    if (*at == ':' && !parameter.readable()) break;
    const auto letter = static_cast<unsigned char>(*at);
    if (std::isalnum(letter) != 0) name += static_cast<char>(std::tolower(letter));
    if (std::isalnum(letter) == 0 && !name.empty() && name.back() != '-') name += '-';
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  const int mode = mode_of(parameter);
  if (mode >= 0 && name.rfind("mode-", 0) == 0) name = fmt::format("mode-{}-{}", mode, name.substr(5));
  return name;
}

const std::map<std::string, int>& uses_of_names() {
  static const std::map<std::string, int> kUses = [] {
    std::map<std::string, int> counted;
    for (const Parameter parameter : firmware::kParameters) ++counted[plain_name(parameter)];
    return counted;
  }();
  return kUses;
}

}  // namespace

std::string name_of(const Parameter& parameter) {
  const std::string name = plain_name(parameter);
  return uses_of_names().at(name) == 1 ? name : fmt::format("{}-{:04x}", name, address_of(parameter.name));
}

Parameter parameter_named(const std::string& name) {
  for (const Parameter parameter : firmware::kParameters) {
    if (name == name_of(parameter)) return parameter;
    if (name.size() == 4 && fmt::format("{:04x}", address_of(parameter.name)) == name) return parameter;
    if (name.size() == 4 && fmt::format("{:04X}", address_of(parameter.name)) == name) return parameter;
  }
  throw sim::bad_argument("register", name,
                          "not known, a name of `drive PORT export` or four hexadecimal digits are accepted");
}

int64_t value_in(const Parameter& parameter, const uint16_t* words) {
  if (parameter.words() == 2) {
    const uint32_t value = uint32_t{words[0]} << 16 | words[1];
    return parameter.is_signed() ? static_cast<int64_t>(static_cast<int32_t>(value)) : static_cast<int64_t>(value);
  }
  return parameter.is_signed() ? static_cast<int64_t>(static_cast<int16_t>(words[0])) : static_cast<int64_t>(words[0]);
}

int64_t read_parameter(sim::RegisterPort& port, const Parameter& parameter) {
  return value_in(parameter, port.read(address_of(parameter.name), static_cast<uint16_t>(parameter.words())).data());
}

void require_fits(const Parameter& parameter, int64_t value) {
  const int bits = 16 * static_cast<int>(parameter.words());
  const int64_t low = parameter.is_signed() ? -(INT64_C(1) << (bits - 1)) : 0;
  const int64_t high = (INT64_C(1) << (parameter.is_signed() ? bits - 1 : bits)) - 1;
  if (value >= low && value <= high) return;
  throw sim::bad_argument(name_of(parameter), std::to_string(value),
                          fmt::format("outside the register, {} to {} is accepted", low, high));
}

void write_parameter(sim::RegisterPort& port, const Parameter& parameter, int64_t value) {
  require_fits(parameter, value);
  try {
    if (parameter.words() == 2) {
      port.write32(address_of(parameter.name), static_cast<uint32_t>(value));
    } else {
      port.write(address_of(parameter.name), static_cast<uint16_t>(value));
    }
  } catch (const sim::RegisterRefusal& refusal) {
    ChipClient(port).explain(refusal);
  }
}

void unlock(sim::RegisterPort& port) {
  port.write(address_of(Register::kCommandKey), static_cast<uint16_t>(firmware::CommandKey::kUnlock));
}

}  // namespace stillpoint::cli
