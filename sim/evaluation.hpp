// SPDX-License-Identifier: Apache-2.0
// What a recorded move is worth: its limits, and the vibration it leaves.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/experiment.hpp"

namespace stillpoint::sim {

// Largest magnitudes of the differences of the setpoints, and whether they keep the limits within the allowance for
// fixed point behind m stages: (m + 1) times 1, 2, 4 LSB on the first, second, third difference. Kinds that step in
// acceleration have no jerk limit. A move that begins in motion is taken to have come there at its start's
// acceleration; it counts as accelerating while its speed grows, and what its start is beyond a limit is allowed.
struct StreamFigures {
  double peak_velocity;      // unit/s
  double peak_acceleration;  // unit/s^2
  double peak_jerk;          // unit/s^3
  bool within_limits;
};
StreamFigures evaluate_stream(const std::vector<Signal>& setpoints, const MoveTask& task, uint32_t stage_count);

// The free vibration from the last setpoint change on, seen between the ticks too.
struct Rest {
  double move_time_s;    // of the last setpoint change
  double residual_peak;  // largest |tip acceleration| after it, unit/s^2
  Arm arm;               // at that instant, the motor standing
};
Rest rest_of(const std::vector<Signal>& setpoints, const MoveTask& task, const ArmModes& arm);

// From the last setpoint change until |tip acceleration| stays at or below `threshold`. Nothing if it never does (or
// not within 2e6 samples of the free vibration, 64 a period).
std::optional<double> settling_time_s(const Rest& rest, double threshold);

// One move's line in the table.
struct MoveFigures {
  double move_time_s;
  double residual_peak;
  std::optional<double> settling_time_s;
  std::optional<double> total_time_s;
  StreamFigures stream;
};

struct Comparison {
  Recording plain;
  Recording shaped;
  MoveFigures plain_figures;
  MoveFigures shaped_figures;
  double residual_ratio;  // shaped over plain; 0 where the plain move leaves nothing
  bool within_limits;     // both streams
  bool zero_delay_met;
};

// Evaluates two recordings on the same arm. `settle_band` is of the plain residual peak. `plain` and `shaped` differ
// at most in duration and zero_delay.
Comparison compare(const MoveTask& plain_task, Recording plain, const MoveTask& shaped_task, Recording shaped,
                   const ArmModes& arm, uint32_t stage_count, double settle_band);

}  // namespace stillpoint::sim
