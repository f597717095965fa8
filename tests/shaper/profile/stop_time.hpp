// SPDX-License-Identifier: Apache-2.0
// The least time of a stop in continuous time, in closed form; and the state of motion that three samples show.
#pragma once

#include <cmath>
#include <cstdint>

#include "shaper/base/signal.hpp"

namespace stillpoint::testing {

struct SampledMotion {
  long double velocity;
  long double acceleration;
};

// Ticks of the shortest stop from there: braking rises at the jerk limit, holds at the deceleration limit, and is let
// go at the jerk limit. In the direction that letting go of the acceleration at once would lead to; acceleration
// outside the limit is let go first.
inline long double least_stop_ticks(const SampledMotion& from, long double deceleration, long double jerk) {
  const long double let_go =
      from.velocity + from.acceleration * std::fabs(from.acceleration) / (2 * jerk);  // velocity after that
  const long double sign = let_go < 0 ? -1 : 1;
  long double v = sign * from.velocity;
  long double b = -sign * from.acceleration;
  long double ticks = 0;
  if (b > deceleration) {
    ticks = (b - deceleration) / jerk;
    v -= (b + deceleration) / 2 * ticks;
    b = deceleration;
  }
  const long double peak = std::sqrt(std::fmax(jerk * v + b * b / 2, 0.0L));
  if (peak <= deceleration) return ticks + (2 * peak - b) / jerk;
  const long double ramps = (deceleration * deceleration - b * b / 2) / jerk;  // velocity that they use
  return ticks + (2 * deceleration - b) / jerk + (v - ramps) / deceleration;
}

// The same from the instant of the newest of three samples.
//
// What the samples say belongs to the instant of the middle one, a tick earlier: the mean of their two steps is the
// velocity there, the difference of the steps the acceleration. (The newest step alone is the velocity half a tick
// ago.)
// Up to the newest sample, after which the stop is asked for, the axis went on with that acceleration: one step of
// velocity. Braking harder than the stop may, though, is not credited to it for that tick, only the tick is: a stop
// within its limits from the middle sample on takes no less.
inline long double least_stop_ticks(Signal newest, Signal middle, Signal oldest, long double deceleration,
                                    long double jerk) {
  const auto step = static_cast<long double>(wrapping_difference(newest, middle));
  const auto step_before = static_cast<long double>(wrapping_difference(middle, oldest));
  const SampledMotion at_middle{(step + step_before) / 2, step - step_before};
  const SampledMotion at_newest{at_middle.velocity + at_middle.acceleration, at_middle.acceleration};
  return std::fmax(least_stop_ticks(at_newest, deceleration, jerk),
                   least_stop_ticks(at_middle, deceleration, jerk) - 1);
}

}  // namespace stillpoint::testing
