// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/base/status.hpp"

namespace stillpoint {

// What a move may do: promises about the setpoint stream, in the caller's position unit (metres, counts, ...).
// Jerks are not used by the trapezoid. A profile keeps `jerk` while it speeds up and `deceleration_jerk` while it slows
// down; behind a shaper, where the one reaches into the other, the larger of the two holds.
struct AxisLimits {
  double velocity;                 // unit/s
  double acceleration;             // unit/s^2, while speeding up
  double deceleration;             // unit/s^2, while slowing down
  double jerk;                     // unit/s^3
  double deceleration_jerk = 0.0;  // unit/s^3, while slowing down; 0: as `jerk`

  [[gnu::noinline]] constexpr double braking_jerk() const {
    return deceleration_jerk == 0.0 ? jerk : deceleration_jerk;
  }
  constexpr double larger_jerk() const { return braking_jerk() > jerk ? braking_jerk() : jerk; }

  // Each must be finite and above zero (the deceleration's jerk: or zero); the refusal names the first that is not.
  // O(1), any context.
  Status validate() const;
  // And the tick they are to be kept at.
  Status validate(double tick_s) const;

  // Refuses, naming quantity and largest value accepted, the first that is larger here than in `maximum`.
  Status within(const AxisLimits& maximum) const;
};

}  // namespace stillpoint
