// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_files.hpp"

#include <fmt/format.h>

#include <fstream>

#include "firmware/parameter_store.hpp"
#include "sim/cli/drive_registers.hpp"
#include "sim/cli/json.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Effect;
using firmware::kParameters;
using firmware::Parameter;
using firmware::Register;

Json values_of(sim::RegisterPort& port, bool staged) {
  Json values = Json::object();
  for (const Parameter parameter : kParameters) {
    if (firmware::stored(parameter) && firmware::of_shaper_set(parameter) == staged) {
      values[name_of(parameter)] = read_parameter(port, parameter);
    }
  }
  return values;
}

struct Setting {
  Parameter parameter;
  int64_t value;
};

std::vector<Setting> settings_in(const Json& values, bool staged) {
  std::vector<Setting> settings;
  for (const auto& [name, value] : values.items()) {
    const Parameter parameter = parameter_named(name);
    if (!firmware::stored(parameter) || firmware::of_shaper_set(parameter) != staged)
      throw sim::bad_argument("setting", name, "not one of these, those of an export are accepted");
    if (!value.is_number_integer())
      throw sim::bad_argument(name, value.dump(), "not a whole number, one in the register's unit is accepted");
    settings.push_back({parameter, value.get<int64_t>()});
  }
  return settings;
}

void write_settings(sim::RegisterPort& port, const std::vector<Setting>& settings, bool axis_limits) {
  for (const Setting& setting : settings) {
    if ((setting.parameter.effect == Effect::kAxisLimits) == axis_limits) {
      write_parameter(port, setting.parameter, setting.value);
    }
  }
}

const Json& part_of(const Json& file, const char* name, bool object) {
  if (!file.is_object() || !file.contains(name) || !(object ? file[name].is_object() : file[name].is_array()))
    throw sim::bad_argument("file", name, "not there, a file that `drive PORT export` wrote is accepted");
  return file[name];
}

}  // namespace

Json exported(sim::RegisterPort& port) {
  Json sets = Json::array();
  const uint16_t on_show = port.read(address_of(Register::kShaperSet), 1)[0];
  Json settings = values_of(port, false);
  for (uint16_t set = 0; set < firmware::kShaperSets; ++set) {
    port.write(address_of(Register::kShaperSet), set);
    sets.push_back(values_of(port, true));
  }
  port.write(address_of(Register::kShaperSet), on_show);
  return {{"product", port.read(address_of(Register::kProduct), 1)[0]},
          {"firmware", port.read(address_of(Register::kFirmwareVersion), 1)[0]},
          {"map_version", port.read(address_of(Register::kMapVersion), 1)[0]},
          {"settings", settings},
          {"shaper_sets", sets}};
}

void import_settings(sim::RegisterPort& port, const Json& file) {
  const std::vector<Setting> settings = settings_in(part_of(file, "settings", true), false);
  std::vector<std::vector<Setting>> sets;
  for (const Json& set : part_of(file, "shaper_sets", false)) sets.push_back(settings_in(set, true));
  if (sets.size() > firmware::kShaperSets)
    throw sim::bad_argument("shaper_sets", std::to_string(sets.size()),
                            fmt::format("too many, {} are accepted", firmware::kShaperSets));
  unlock(port);
  write_settings(port, settings, true);
  write_settings(port, settings, false);
  const uint16_t on_show = port.read(address_of(Register::kShaperSet), 1)[0];
  for (size_t set = 0; set < sets.size(); ++set) {
    port.write(address_of(Register::kShaperSet), static_cast<uint16_t>(set));
    write_settings(port, sets[set], false);
  }
  port.write(address_of(Register::kShaperSet), on_show);
}

Json read_json_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw sim::bad_argument("file", path, "cannot be read, a file that can be is accepted");
  Json object = Json::parse(file, nullptr, false);
  if (object.is_discarded()) throw sim::bad_argument("file", path, "is not JSON, an export is accepted");
  return object;
}

void write_json_file(const std::string& path, const Json& object) {
  std::ofstream file(path);
  file << object.dump(2) << '\n';
  if (!file.flush()) throw sim::bad_argument("file", path, "cannot be written, a file that can be is accepted");
}

}  // namespace stillpoint::cli
