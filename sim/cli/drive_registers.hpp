// SPDX-License-Identifier: Apache-2.0
// The drive's parameters by name, over a port.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/parameters.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

// "profile-velocity", "mode-0-frequency": what the table calls it, in small letters and without what is in brackets;
// where two would be called the same, its address follows.
std::string name_of(const firmware::Parameter& parameter);

// By that name, or by its address in four hexadecimal digits. Throws a Refusal.
firmware::Parameter parameter_named(const std::string& name);

// Its registers' words as the type has them: signed where that is.
int64_t value_in(const firmware::Parameter& parameter, const uint16_t* words);
int64_t read_parameter(sim::RegisterPort& port, const firmware::Parameter& parameter);

// Refuses what the type cannot hold.
void require_fits(const firmware::Parameter& parameter, int64_t value);

// Refuses what the type cannot hold before it is sent, and repeats what the drive says where it refuses.
void write_parameter(sim::RegisterPort& port, const firmware::Parameter& parameter, int64_t value);

// Unlocks what needs the key, for a minute.
void unlock(sim::RegisterPort& port);

}  // namespace stillpoint::cli
