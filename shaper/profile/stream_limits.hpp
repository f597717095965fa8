// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "shaper/base/status.hpp"
#include "shaper/profile/approach_curve.hpp"
#include "shaper/profile/limits.hpp"

namespace stillpoint {

// Limits of a stream, made ready for the tick: the differences, in whole LSB, that a stream may have which keeps the
// limits and is rounded to LSB. That is a limit and 1, 2, 4 LSB for velocity, acceleration, jerk.
struct StreamLimits {
  int64_t velocity;          // LSB/tick
  int64_t acceleration;      // LSB/tick^2, while the speed grows
  int64_t deceleration;      // while it falls
  int64_t jerk;              // LSB/tick^3
  ApproachCurve curve;       // for catching up, within the deceleration
  ApproachCurve soft_curve;  // and within the smaller of the accelerations

  // Background. `limits` in counts and seconds; of two jerks the larger holds, as behind a shaper. Refuses what
  // AxisLimits refuses, a tick not above zero, and what is less than an LSB, and leaves `out`. A velocity above 2^56
  // LSB/tick (1.7e10 counts/s at 1 ms) counts as that.
  static Status make(const AxisLimits& limits, double tick_s, StreamLimits& out);

  int64_t smaller_acceleration() const { return acceleration < deceleration ? acceleration : deceleration; }
  int64_t larger_acceleration() const { return acceleration < deceleration ? deceleration : acceleration; }
};

}  // namespace stillpoint
