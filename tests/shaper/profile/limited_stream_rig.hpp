// SPDX-License-Identifier: Apache-2.0
// A limiter under test, watched, and random limits for it.
#pragma once

#include <cmath>

#include "shaper/profile/stream_limiter.hpp"
#include "tests/shaper/profile/limited_stream.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

constexpr double kTick = 1e-3;
constexpr double kLsb = 4294967296.0;

inline double decades(Random& random, double low, double high) { return std::pow(10.0, random.between(low, high)); }

// Counts/s over five decades; ramps of 1 to 1000 ticks, of acceleration and of velocity. `spread` 0: symmetric.
inline AxisLimits random_limits(Random& random, double spread) {
  const double velocity = decades(random, 3.0, 8.0);
  const double acceleration = velocity * decades(random, 0.0, 3.0);
  const double deceleration = acceleration * decades(random, -spread, spread);
  return AxisLimits{velocity, acceleration, deceleration, acceleration * decades(random, 0.0, 3.5)};
}

inline StreamLimits made(const AxisLimits& limits) {
  StreamLimits made{};
  TEST_ASSERT_OK(StreamLimits::make(limits, kTick, made));
  return made;
}

inline int64_t lsb_per_tick(double counts_per_s) { return static_cast<int64_t>(counts_per_s * kTick * kLsb); }

// A limiter, what it was given and what it promised.
struct Stream {
  StreamLimiter limiter = {};
  LimitedStream watch;
  Signal input = 0;

  Stream(const AxisLimits& limits, StreamPolicy policy, int64_t velocity = 0) : watch(limits, kTick, 0, velocity, 0) {
    limiter.start(made(limits), policy, 0, 0, wrapping_difference(0, velocity), wrapping_difference(0, 2 * velocity));
  }

  Signal step(Signal next) {
    input = next;
    const uint32_t before = limiter.limited_ticks();
    const Signal output = limiter.tick(next);
    watch.next(output);
    TEST_ASSERT_TRUE(limiter.limiting() == (output != next));
    TEST_ASSERT_EQUAL_UINT32(before + (output != next ? 1 : 0), limiter.limited_ticks());
    return output;
  }
  void pass(Signal next) { TEST_ASSERT_EQUAL_INT64(next, step(next)); }
};

}  // namespace stillpoint::testing
