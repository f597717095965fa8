// SPDX-License-Identifier: Apache-2.0
// Prototypes put on the ticks, their zeros exactly on the sampled poles (reference 3). Background; doubles.
#pragma once

#include "shaper/shaping/prototype.hpp"
#include "shaper/shaping/response.hpp"

namespace stillpoint {

constexpr double kHighestCyclesATick = 0.49;  // of any zero: half a period must last at least a tick

// A ZV stage of three taps for each zero. `cycles_a_tick`: of the mode, f dt; zeros at most kHighestCyclesATick.
Cascade cascade_on_grid(const Zero* zeros, uint32_t count, double cycles_a_tick);

// Where the impulses of a train go: the first at 0, each other split over `tick` and the next.
struct SplitTicks {
  uint32_t count;
  uint32_t tick[kMaxZeros];
};
// The ticks on either side of each impulse; later ones where two splits would share a tick.
SplitTicks split_ticks(const Cascade& train, double cycles_a_tick);

// The train whose gains put all `count` zeros on their poles: 2 count + 1 linear equations in the 2 count + 1 taps of
// count + 1 impulses. False where the equations are singular. Cost: 9 exp, sin, cos a zero and 9^3/3 multiplications.
[[nodiscard]] bool train_on_grid(const Zero* zeros, uint32_t count, const SplitTicks& ticks, double cycles_a_tick,
                                 Cascade& out);

// Moves an impulse by a tick where its gains have opposite signs: the zeros want it elsewhere. True if any moved.
bool follow_signs(const Cascade& train, SplitTicks& ticks);

}  // namespace stillpoint
