// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "firmware/parameter_store.hpp"
#include "sim/cli/chip_client.hpp"
#include "sim/cli/drive_registers.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Effect;
using firmware::kParameters;
using firmware::Parameter;
using firmware::Register;

constexpr size_t kOwn = SIZE_MAX;  // no set
constexpr uint16_t kLow = address_of(Register::kSoftLimitLow);
constexpr uint16_t kHigh = address_of(Register::kSoftLimitHigh);
static_assert(kHigh == kLow + 2, "one request");

Parameter parameter_at(uint16_t address) { return kParameters[firmware::find_parameter(address)]; }

// Whatever happens, the set that was on show is so again.
class ShownSet {
 public:
  explicit ShownSet(sim::RegisterPort& port) : port_(port), before_(port.read(kAddress, 1)[0]) {}
  ~ShownSet() {
    try {
      show(before_);
    } catch (const sim::Refusal&) {  // silent: what ended it says so
    }
  }
  ShownSet(const ShownSet&) = delete;
  ShownSet& operator=(const ShownSet&) = delete;
  void show(size_t set) { port_.write(kAddress, static_cast<uint16_t>(set)); }

 private:
  static constexpr uint16_t kAddress = address_of(Register::kShaperSet);
  sim::RegisterPort& port_;
  uint16_t before_;
};

// Neighbours in one request.
SettingValues read_values(sim::RegisterPort& port, bool of_set) {
  constexpr size_t kMostWords = 120;
  std::vector<Parameter> run;
  size_t words = 0;
  SettingValues values;
  const auto fetch = [&] {
    if (run.empty()) return;
    const uint16_t first = address_of(run.front().name);
    const std::vector<uint16_t> got = port.read(first, static_cast<uint16_t>(words));
    for (const Parameter& parameter : run)
      values[address_of(parameter.name)] = value_in(parameter, &got[address_of(parameter.name) - size_t{first}]);
    run.clear();
    words = 0;
  };
  for (const Parameter parameter : kParameters) {
    if (!is_setting(parameter, of_set)) continue;
    const bool next = !run.empty() && address_of(parameter.name) == address_of(run.front().name) + words;
    if (!next || words + parameter.words() > kMostWords) fetch();
    run.push_back(parameter);
    words += parameter.words();
  }
  fetch();
  return values;
}

std::set<uint16_t> ceilings() {
  std::set<uint16_t> addresses;
  for (const Parameter parameter : kParameters)
    if (parameter.ceiling != firmware::kNoRegister) addresses.insert(address_of(parameter.ceiling));
  return addresses;
}

class Writer {
 public:
  Writer(sim::RegisterPort& port, DriveSettings now) : port_(port), now_(std::move(now)) {}

  void write(const DriveSettings& wanted) {
    unlock(port_);
    const std::set<uint16_t> bounds = ceilings();
    for (const uint16_t ceiling : bounds) put(kOwn, ceiling, highest_needed(ceiling, wanted.own));
    put_soft_limits(wanted.own);
    for (const auto& [address, value] : wanted.own)
      if (bounds.count(address) == 0) put(kOwn, address, value);
    for (const uint16_t ceiling : bounds)
      if (wanted.own.count(ceiling) != 0) put(kOwn, ceiling, wanted.own.at(ceiling));
    ShownSet shown(port_);
    for (size_t set = 0; set < wanted.sets.size(); ++set) {
      if (wanted.sets[set] == now_.sets[set]) continue;
      shown.show(set);
      for (const auto& [address, value] : wanted.sets[set]) put(set, address, value);
    }
  }

  std::string written() const {
    std::string names;
    for (const std::string& name : written_) names += (names.empty() ? "" : ", ") + name;
    return names;
  }
  bool wrote() const { return !written_.empty(); }

 private:
  // What it is now, if nothing asks for more.
  int64_t highest_needed(uint16_t ceiling, const SettingValues& wanted) const {
    int64_t highest = now_.own.at(ceiling);
    for (const auto& [address, value] : wanted)
      if (address == ceiling || address_of(parameter_at(address).ceiling) == ceiling)
        highest = std::max(highest, value);
    return highest;
  }

  // Both in one request: between the new one and the old one an axis may stand that is enabled.
  void put_soft_limits(const SettingValues& wanted) {
    const int64_t low = value_of(kLow, wanted);
    const int64_t high = value_of(kHigh, wanted);
    if (low == now_.own.at(kLow) && high == now_.own.at(kHigh)) return;
    const auto word = [](int64_t value, int shift) { return static_cast<uint16_t>(value >> shift); };
    const std::vector<uint16_t> words = {word(low, 16), word(low, 0), word(high, 16), word(high, 0)};
    written_as(name_of(parameter_at(kLow)) + ", " + name_of(parameter_at(kHigh)), [&] {
      try {
        port_.write(kLow, words);
      } catch (const sim::RegisterRefusal& refusal) {
        ChipClient(port_).explain(refusal);
      }
    });
    now_.own[kLow] = low;
    now_.own[kHigh] = high;
  }
  int64_t value_of(uint16_t address, const SettingValues& wanted) const {
    const auto given = wanted.find(address);
    return given != wanted.end() ? given->second : now_.own.at(address);
  }

  void put(size_t set, uint16_t address, int64_t value) {
    SettingValues& values = set == kOwn ? now_.own : now_.sets[set];
    if (values.at(address) == value) return;
    const Parameter parameter = parameter_at(address);
    written_as(set == kOwn ? name_of(parameter) : fmt::format("{} of set {}", name_of(parameter), set),
               [&] { write_parameter(port_, parameter, value); });
    values[address] = value;
  }

  // It may have been taken though no answer came.
  template <typename Write>
  void written_as(const std::string& name, const Write& write) {
    written_.push_back(name);
    try {
      write();
    } catch (const sim::Refusal& refusal) {
      if (refusal.result() != "client_silent") written_.pop_back();
      throw;
    }
  }

  sim::RegisterPort& port_;
  DriveSettings now_;
  std::vector<std::string> written_;
};

std::string put_back(sim::RegisterPort& port, const DriveSettings& before, const Writer& writer) {
  if (!writer.wrote()) return "; nothing has been changed";
  try {
    Writer(port, read_settings(port)).write(before);
    return "; all is as it was before";
  } catch (const sim::Refusal&) {
    return "; written and perhaps not put back: " + writer.written();
  }
}

void check_value(const Parameter& parameter, int64_t value, int64_t ceiling) {
  require_fits(parameter, value);
  uint32_t accepted = 0;
  if (firmware::in_range(parameter, static_cast<uint32_t>(ceiling), static_cast<uint32_t>(value), accepted)) return;
  if (accepted == static_cast<uint32_t>(value))
    throw sim::bad_argument(name_of(parameter), std::to_string(value),
                            "not available in this firmware, what its register map has is accepted");
  const int64_t nearest = parameter.is_signed() ? int64_t{static_cast<int32_t>(accepted)} : int64_t{accepted};
  throw sim::bad_argument(name_of(parameter), std::to_string(value),
                          fmt::format("out of range, {} is accepted", nearest));
}

}  // namespace

bool is_setting(const Parameter& parameter, bool of_set) {
  return firmware::stored(parameter) && firmware::of_shaper_set(parameter) == of_set;
}

DriveSettings read_settings(sim::RegisterPort& port) {
  DriveSettings settings;
  settings.own = read_values(port, false);
  ShownSet shown(port);
  for (size_t set = 0; set < firmware::kShaperSets; ++set) {
    shown.show(set);
    settings.sets.push_back(read_values(port, true));
  }
  return settings;
}

void check_settings(const DriveSettings& wanted, const DriveSettings& now) {
  for (const auto& [address, value] : wanted.own) {
    const Parameter parameter = parameter_at(address);
    int64_t ceiling = parameter.maximum;
    if (parameter.ceiling != firmware::kNoRegister) {
      const auto given = wanted.own.find(address_of(parameter.ceiling));
      const bool may_be_above = parameter.effect == Effect::kAxisLimits && given != wanted.own.end();
      if (!may_be_above)
        ceiling = given != wanted.own.end() ? given->second : now.own.at(address_of(parameter.ceiling));
    }
    check_value(parameter, value, ceiling);
  }
  for (const SettingValues& set : wanted.sets) {
    for (const auto& [address, value] : set) {
      const Parameter parameter = parameter_at(address);
      check_value(parameter, value, parameter.maximum);
    }
  }
}

void write_settings(sim::RegisterPort& port, const DriveSettings& wanted) {
  const DriveSettings before = read_settings(port);
  check_settings(wanted, before);
  Writer writer(port, before);
  try {
    writer.write(wanted);
  } catch (const sim::Refusal& refusal) {
    throw refusal.with(put_back(port, before, writer));
  }
}

}  // namespace stillpoint::cli
