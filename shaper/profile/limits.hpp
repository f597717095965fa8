// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/base/status.hpp"

namespace stillpoint {

// What a move may do: promises about the setpoint stream, in the caller's position unit (metres, counts, ...).
// `jerk` is not used by the trapezoid.
struct AxisLimits {
  double velocity;      // unit/s
  double acceleration;  // unit/s^2, while speeding up
  double deceleration;  // unit/s^2, while slowing down
  double jerk;          // unit/s^3

  // Each must be finite and above zero; the refusal names the first that is not. O(1), any context.
  Status validate() const;

  // Refuses, naming quantity and largest value accepted, the first that is larger here than in `maximum`.
  Status within(const AxisLimits& maximum) const;
};

}  // namespace stillpoint
