// SPDX-License-Identifier: Apache-2.0
// What a scope has captured: as a file, as a picture, in numbers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/cli/csv.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/plot.hpp"

namespace stillpoint::cli {

// Time 0 is the first sample after the trigger.
struct ScopeRecord {
  std::vector<double> time_s;
  std::vector<std::string> names;  // of the channels
  std::vector<std::vector<double>> channels;
};

// "setpoint", "following-error", ...: firmware::ScopeSource, from 1 on.
constexpr char kScopeChannels[] =
    "demand setpoint position following-error demand-velocity setpoint-velocity velocity accelerometer phase fault "
    "flags";

// 1 on; refuses what is not one of them.
uint16_t scope_channel_named(const std::string& name);
const char* scope_channel_name(uint16_t source);

void write_scope_csv(const std::string& path, const Settings& settings, const ScopeRecord& record);
// A file that write_scope_csv wrote, or any table whose first column is a time in s.
ScopeRecord read_scope_csv(const std::string& path);

// A panel for each unit; the trigger a dashed line.
void draw_scope(const std::string& path, const std::string& title, const ScopeRecord& record);

// Each channel's least, most and last value.
Json json_of(const ScopeRecord& record);
void print_scope(const ScopeRecord& record);

}  // namespace stillpoint::cli
