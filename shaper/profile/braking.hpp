// SPDX-License-Identifier: Apache-2.0
// How hard to brake in a tick so as to come to no velocity and no acceleration together, in the fewest ticks.
#pragma once

#include <stdint.h>

namespace stillpoint {

// Everything that enters is below this, so that the sum of two and twice one fit.
constexpr int64_t kMotionLimit = INT64_C(1) << 62;

constexpr int64_t within_motion_limit(int64_t value) {
  constexpr int64_t kMost = kMotionLimit - 1;
  return value > kMost ? kMost : value < -kMost ? -kMost : value;
}

// Braking b in this tick, and let go by J a tick from the next on, uses up the velocity
//   H(b) = b + (b - J) + (b - 2J) + ... = (n + 1) (2b - nJ) / 2,   n = floor(b / J),
// which rises with b. The answer is the largest braking, at most `most` and within `jerk` of `braking`, whose H is no
// more than `velocity`: a harder one could not be let go in time, a softer one lasts longer. What the whole numbers
// leave is let go on the way, so the end is exact. Where even braking - jerk is too much, or above `most`, it is that.
//
// For velocity >= 0, any braking (below zero: speeding up), most > 0 and 0 < J <= jerk <= 4J, J being `let_go_jerk`;
// all per tick and within the motion limit. Tick context. Two short divisions by shifting: one turn for each bit of
// braking over J, and of J.
int64_t next_braking(int64_t velocity, int64_t braking, int64_t most, int64_t jerk, int64_t let_go_jerk);

// H(braking) <= velocity, for any braking below kMotionLimit and velocity >= 0.
bool can_let_go(int64_t braking, int64_t let_go_jerk, int64_t velocity);

}  // namespace stillpoint
