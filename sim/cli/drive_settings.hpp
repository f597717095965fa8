// SPDX-License-Identifier: Apache-2.0
// A drive's settings as a whole: what it stores.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "firmware/parameters.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

using SettingValues = std::map<uint16_t, int64_t>;  // by address, in the register's unit

struct DriveSettings {
  SettingValues own;
  std::vector<SettingValues> sets;  // of the shaper sets, what they have staged
};

bool is_setting(const firmware::Parameter& parameter, bool of_set);

// The set on show is the one before, afterwards, as with all of these.
DriveSettings read_settings(sim::RegisterPort& port);

// Refuses by the register's name what a drive that has `now` would not end up with: what is out of its range, or above
// its ceiling. A limit of the axis's own may be above its ceiling where both are given: a drive can be so.
void check_settings(const DriveSettings& wanted, const DriveSettings& now);

// Writes those that differ from what the drive has. A ceiling goes up before, and down after, what is under it. Needs
// the axis standing where limits of its own change. Where the drive refuses one, or is no longer heard, all that was
// written is put back, and what is thrown says so, or what has stayed.
void write_settings(sim::RegisterPort& port, const DriveSettings& wanted);

}  // namespace stillpoint::cli
