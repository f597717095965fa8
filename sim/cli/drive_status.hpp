// SPDX-License-Identifier: Apache-2.0
// What a drive says of itself.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/cli/command.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

struct FaultRecord {
  uint16_t code;
  uint16_t count;  // how often it has come, this one included, since the history was empty
  uint32_t uptime_ms;
  int32_t position_counts;
  int32_t demand_counts;
};

// The newest first.
std::vector<FaultRecord> fault_history(sim::RegisterPort& port);

// As tables or JSON. The exit code.
int show_status(sim::RegisterPort& port, const Output& output);
int show_faults(sim::RegisterPort& port, const Output& output);

}  // namespace stillpoint::cli
