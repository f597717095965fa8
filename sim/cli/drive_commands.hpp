// SPDX-License-Identifier: Apache-2.0
// What a person tells a drive, and from which states: each does what its name says, or nothing and says why.
#pragma once

#include <cstdint>

#include "sim/cli/register_values.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

// All of them throw a Refusal: `drive_fault` where the drive is in a fault, `not_enabled`, `quick_stop`, `no_fault`,
// `mode_in_force` as below, and what the drive itself refuses; then nothing has been written that changes its state.

// To operation enabled, as ChipClient::enable.
void enable_drive(sim::RegisterPort& port);

// Torque off at once, whatever moves, from any state.
void disable_drive(sim::RegisterPort& port);

// A ramp by the profile's limits, then torque at rest until another move. Only in operation enabled, or it would enable
// a drive that is off, or end a quick stop.
void halt_drive(sim::RegisterPort& port);

// The quick stop of 0078; a drive that is off, or in a fault, stays so.
void stop_drive(sim::RegisterPort& port);

// Once a fault's reaction is over. A drive without a fault is left alone: the bit's edge comes with torque off.
void reset_drive(sim::RegisterPort& port);

// The settings into the memory that a power cut leaves; accepted while the drive is off, in a fault too.
void save_settings(sim::RegisterPort& port);

// For whatever enables a drive in order to move it: refuses a fault and a quick stop.
void refuse_unless_ready_to_move(sim::RegisterPort& port);

struct MoveRequest {
  int32_t counts;
  bool relative;  // to the target in force
};

// In profile position mode, which is put in force first where the axis stands; enables a drive that is off. A quick
// stop is not ended by it.
MoveReport start_move(sim::RegisterPort& port, const MoveRequest& request);

}  // namespace stillpoint::cli
