// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <system_error>

#include "sim/cli/drive_registers.hpp"
#include "sim/cli/drive_settings.hpp"
#include "sim/cli/json.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Parameter;
using firmware::Register;

// What a file says of the drive that it is from.
struct Origin {
  const char* key;
  Register name;
};
constexpr Origin kProduct = {"product", Register::kProduct};
constexpr Origin kFirmware = {"firmware", Register::kFirmwareVersion};
constexpr Origin kMap = {"map_version", Register::kMapVersion};

Json json_of(const SettingValues& values) {
  Json object = Json::object();
  for (const auto& [address, value] : values)
    object[name_of(firmware::kParameters[firmware::find_parameter(address)])] = value;
  return object;
}

SettingValues settings_in(const Json& object, bool of_set) {
  if (!object.is_object())
    throw sim::bad_argument("settings", object.dump(), "no names and values, those of an export are accepted");
  SettingValues settings;
  for (const auto& [name, value] : object.items()) {
    const Parameter parameter = parameter_named(name);
    if (!is_setting(parameter, of_set))
      throw sim::bad_argument("setting", name, "not one of these, those of an export are accepted");
    if (!value.is_number_integer())
      throw sim::bad_argument(name, value.dump(), "not a whole number, one in the register's unit is accepted");
    const bool beyond = value.is_number_unsigned() && value.get<uint64_t>() > INT64_MAX;
    const int64_t number = beyond ? INT64_MAX : value.get<int64_t>();
    if (!settings.emplace(address_of(parameter.name), number).second)
      throw sim::bad_argument("setting", name, "there twice, by its name or its address once is accepted");
  }
  return settings;
}

const Json& part_of(const Json& file, const char* name, bool object) {
  if (!file.is_object() || !file.contains(name) || !(object ? file[name].is_object() : file[name].is_array()))
    throw sim::bad_argument("file", name, "not there, a file that `drive PORT export` wrote is accepted");
  return file[name];
}

DriveSettings settings_of(const Json& file) {
  DriveSettings settings;
  settings.own = settings_in(part_of(file, "settings", true), false);
  for (const Json& set : part_of(file, "shaper_sets", false)) settings.sets.push_back(settings_in(set, true));
  if (settings.sets.size() > firmware::kShaperSets)
    throw sim::bad_argument("shaper_sets", std::to_string(settings.sets.size()),
                            fmt::format("too many, {} are accepted", firmware::kShaperSets));
  return settings;
}

// Empty where the file and the drive agree.
std::string difference(sim::RegisterPort& port, const Json& file, const Origin& origin) {
  const uint16_t own = port.read(address_of(origin.name), 1)[0];
  if (!file.contains(origin.key)) return fmt::format("not in the file, the drive's is {}", own);
  if (file[origin.key] == own) return "";
  return fmt::format("{} in the file, the drive's is {}", file[origin.key].dump(), own);
}

std::vector<std::string> check_origin(sim::RegisterPort& port, const Json& file) {
  if (file.contains(kProduct.key) && !difference(port, file, kProduct).empty()) {
    throw sim::bad_argument(
        kProduct.key, file[kProduct.key].dump(),
        fmt::format("another product's, {} is accepted", port.read(address_of(kProduct.name), 1)[0]));
  }
  std::vector<std::string> told;
  for (const Origin& origin : {kProduct, kFirmware, kMap}) {
    const std::string difference_said = difference(port, file, origin);
    if (!difference_said.empty()) told.push_back(std::string(origin.key) + ": " + difference_said);
  }
  return told;
}

void tell_differences(const SettingValues& wanted, const SettingValues& now, const std::string& where,
                      std::vector<std::string>& told) {
  for (const auto& [address, value] : wanted) {
    if (now.at(address) == value) continue;
    const std::string name = name_of(firmware::kParameters[firmware::find_parameter(address)]);
    told.push_back(fmt::format("{}{}: {} in the file, the drive has made it {}", name, where, value, now.at(address)));
  }
}

}  // namespace

Json exported(sim::RegisterPort& port) {
  const DriveSettings settings = read_settings(port);
  Json sets = Json::array();
  for (const SettingValues& set : settings.sets) sets.push_back(json_of(set));
  const auto word = [&](const Origin& origin) { return port.read(address_of(origin.name), 1)[0]; };
  return {{kProduct.key, word(kProduct)},
          {kFirmware.key, word(kFirmware)},
          {kMap.key, word(kMap)},
          {"settings", json_of(settings.own)},
          {"shaper_sets", sets}};
}

std::vector<std::string> import_settings(sim::RegisterPort& port, const Json& file) {
  const DriveSettings wanted = settings_of(file);
  std::vector<std::string> told = check_origin(port, file);
  write_settings(port, wanted);
  const DriveSettings now = read_settings(port);
  tell_differences(wanted.own, now.own, "", told);
  for (size_t set = 0; set < wanted.sets.size(); ++set)
    tell_differences(wanted.sets[set], now.sets[set], fmt::format(" of set {}", set), told);
  return told;
}

Json read_json_file(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown))
    throw sim::bad_argument("file", path, "a directory, a file that can be read is accepted");
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
