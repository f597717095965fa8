// SPDX-License-Identifier: Apache-2.0
// Watches a setpoint stream, tick by tick, against the limits it promises.
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/profile/limits.hpp"

namespace stillpoint::testing {

// The worst that a stream's differences exceed its limits by, in LSB of the signal; an excess of 0 or less is within.
class StreamCheck {
 public:
  // Limits in counts/s^n along the move: acceleration while |velocity| grows in the direction of travel.
  StreamCheck(Signal start, bool forward, const AxisLimits& limits, double tick_s)
      : last_(start),
        forward_(forward),
        velocity_limit_(limits.velocity * tick_s * kLsb),
        acceleration_limit_(limits.acceleration * tick_s * tick_s * kLsb),
        deceleration_limit_(limits.deceleration * tick_s * tick_s * kLsb),
        jerk_limit_(limits.larger_jerk() * tick_s * tick_s * tick_s * kLsb) {}

  void next(Signal signal) {
    const int64_t step = forward_ ? signal - last_ : last_ - signal;
    const int64_t change = step - velocity_;
    const double jerk = static_cast<double>(change) - static_cast<double>(acceleration_);
    last_ = signal;
    velocity_ = step;
    acceleration_ = change;
    const double v = static_cast<double>(step);
    const double a = static_cast<double>(change);
    raise(velocity_excess, (v < 0 ? -v : v) - velocity_limit_);
    raise(acceleration_excess, a > 0 ? a - acceleration_limit_ : -a - deceleration_limit_);
    raise(jerk_excess, (jerk < 0 ? -jerk : jerk) - jerk_limit_);
    raise(backwards, -v);
  }

  // design.md 8: behind m stages m + 1 times 1, 2, 4 LSB.
  bool within(uint32_t stages, bool jerk_limited = true) const {
    const double roundings = stages + 1.0;
    return velocity_excess <= roundings && acceleration_excess <= 2 * roundings &&
           (!jerk_limited || jerk_excess <= 4 * roundings);
  }

  double velocity_excess = -1e300;
  double acceleration_excess = -1e300;
  double jerk_excess = -1e300;
  double backwards = -1e300;

 private:
  static constexpr double kLsb = 4294967296.0;
  static void raise(double& worst, double value) {
    if (value > worst) worst = value;
  }

  Signal last_;
  bool forward_;
  double velocity_limit_;
  double acceleration_limit_;
  double deceleration_limit_;
  double jerk_limit_;
  int64_t velocity_ = 0;
  int64_t acceleration_ = 0;
};

}  // namespace stillpoint::testing
