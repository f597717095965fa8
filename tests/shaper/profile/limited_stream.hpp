// SPDX-License-Identifier: Apache-2.0
// Watches what leaves a stream limiter; positions may wrap.
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/profile/limits.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

// Asserts at every output that the limits are kept, to 1, 2 and 4 LSB. Where the velocity turns, or is less than one
// tick of the larger acceleration, the larger holds.
class LimitedStream {
 public:
  LimitedStream(const AxisLimits& limits, double tick_s, Signal newest = 0, int64_t velocity = 0,
                int64_t acceleration = 0)
      : velocity_limit_(limits.velocity * tick_s * kUnit),
        acceleration_limit_(limits.acceleration * tick_s * tick_s * kUnit),
        deceleration_limit_(limits.deceleration * tick_s * tick_s * kUnit),
        jerk_limit_(limits.larger_jerk() * tick_s * tick_s * tick_s * kUnit),
        position_(newest),
        velocity_(velocity),
        acceleration_(acceleration) {}

  void next(Signal output) {
    const int64_t velocity = wrapping_difference(output, position_);
    const int64_t acceleration = wrapping_difference(velocity, velocity_);
    const int64_t jerk = wrapping_difference(acceleration, acceleration_);
    const double larger = acceleration_limit_ > deceleration_limit_ ? acceleration_limit_ : deceleration_limit_;
    const double v = magnitude(velocity), before = magnitude(velocity_);
    // What rounds away of a limit is part of the allowance, so also of where the turn is.
    const bool turns = (velocity > 0) != (velocity_ > 0) || v < larger + 2.0 || before < larger + 2.0;
    TEST_ASSERT_AT_MOST_DOUBLE(velocity_limit_ + 1.0, v);
    TEST_ASSERT_AT_MOST_DOUBLE((turns        ? larger
                                : v > before ? acceleration_limit_
                                             : deceleration_limit_) +
                                   2.0,
                               magnitude(acceleration));
    TEST_ASSERT_AT_MOST_DOUBLE(jerk_limit_ + 4.0, magnitude(jerk));
    position_ = output;
    velocity_ = velocity;
    acceleration_ = acceleration;
  }

  int64_t velocity() const { return velocity_; }

 private:
  // LSB a count, and as much more as the products round by
  static constexpr double kUnit = 4294967296.0 * (1.0 + 1e-15);
  static double magnitude(int64_t value) {
    return value < 0 ? -static_cast<double>(value) : static_cast<double>(value);
  }

  double velocity_limit_;
  double acceleration_limit_;
  double deceleration_limit_;
  double jerk_limit_;
  Signal position_;
  int64_t velocity_;
  int64_t acceleration_;
};

}  // namespace stillpoint::testing
