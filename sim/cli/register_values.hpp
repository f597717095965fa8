// SPDX-License-Identifier: Apache-2.0
// A move and its shapers as the drive's registers hold them (drive-map.md): what the chip is given, and, rounded alike,
// what the host runs from.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/cli/move_job.hpp"
#include "sim/tuning.hpp"

namespace stillpoint::cli {

struct ModeRegisters {
  uint32_t frequency;  // 1e-4 Hz
  uint16_t damping;    // 1e-5
  uint16_t tolerance;  // 0.01 %
  uint16_t kind;
  uint16_t spacing;  // 1e-4 damped periods
};

struct MoveRegisters {
  int32_t target;         // counts
  uint32_t velocity;      // counts/s
  uint32_t acceleration;  // counts/s^2
  uint32_t deceleration;
  uint32_t jerk;  // 1000 counts/s^3
  int16_t kind;
  uint32_t duration_ms;
  uint16_t zero_delay;
};

// Registers 0201 on.
struct TuneRegisters {
  uint16_t excitation;
  uint32_t amplitude;  // counts; where the move excites, its distance
  uint32_t travel;     // counts
  uint16_t band_low;   // 0.1 Hz
  uint16_t band_high;
  uint16_t source;
  uint16_t tolerance;     // 0.01 %
  int32_t sensor_lowest;  // raw steps
  int32_t sensor_highest;
};
TuneRegisters tune_registers_of(const sim::TuneTask& task);

// Each to the nearest register value. Refuses what no register can hold, and a tick that is not the firmware's.
MoveRegisters registers_of(const sim::MoveTask& task);
std::vector<ModeRegisters> registers_of(const std::vector<sim::SpecifiedShaper>& specs);

// What the registers of a mode say.
sim::SpecifiedShaper specified(const ModeRegisters& mode);
std::vector<sim::SpecifiedShaper> specified(const std::vector<ModeRegisters>& modes);

// The specification as its registers have it. Refuses as registers_of.
void round_to_registers(sim::SpecifiedShaper& spec);

// The job with every quantity as its register has it.
MoveJob rounded(const MoveJob& job);

}  // namespace stillpoint::cli
