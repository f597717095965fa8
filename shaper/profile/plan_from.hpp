// SPDX-License-Identifier: Apache-2.0
// The fastest jerk-limited move from any state of motion: to rest at a target, or to a velocity. Background context:
// floating point, bounded work.
#pragma once

#include "shaper/base/status.hpp"
#include "shaper/profile/limits.hpp"
#include "shaper/profile/plan.hpp"

namespace stillpoint {

// Where a plan takes over.
struct StartMotion {
  double velocity;      // unit/s
  double acceleration;  // unit/s^2
};

// Plans from `start` to rest at `distance` from here (signed, any unit) in the least time.
//
// How: stopping at once leads to some place; the target lies ahead of it or behind, and that is the direction of the
// move. In that direction go forward as hard as the limits allow (acceleration, then cruise), and from some moment on
// stop as hard as they allow. The later the moment the farther the stop, never nearer, so the moment that ends on the
// target is the root of a monotone function. That covers every shape at once, with a cruise and without, and those
// whose acceleration keeps its sign: braking already, the target a little beyond the stop, it eases off and brakes on.
// The shape is what the maximum principle gives where the limits of speeding up and slowing down are equal, so that
// they are convex; for the rest, also for two jerks, the evidence is a search over all sequences of jerk, in tests/
// shaper/profile/lattice_optimum.hpp (40 sets of limits, half of them with jerks up to 3 times apart, 200,000 states:
// never faster; November 2026).
//
// Acceleration and jerk count as that while the speed grows, as deceleration and braking jerk while it falls. From
// outside a limit the acceleration comes back first, by the jerk limit; then the velocity, by the deceleration limit;
// and where no jerk within the limit keeps a velocity or acceleration from passing its own, it passes by as little as
// possible.
//
// The plan lasts N = ceil(T/dt) ticks, T its optimum_ticks. Its start is given, so it must not be stretched: slowing it
// would make the velocity jump. It is at rest on the target at T and stays for the rest of its last tick, which keeps
// every limit and costs no tick. At most 12 segments, continuous in acceleration.
//
// Two limits are not used to the last. It cruises 2e-13 below the velocity limit, so that a track's rounding over a
// million ticks does not pass it: where T would be a whole number of ticks, it may take one more. And of a jerk limit
// above 1024 times the larger acceleration a tick, or 4096 times the largest of distance, velocity and acceleration in
// ticks, only as much is used, unless the start needs more to keep its limits: beyond, it shortens a move by less than
// a tick, and its numbers cost digits.
//
// Scale-free, in units and ticks in which the numbers lie between 1e-100 and 1e100. Refuses, leaving `out`: what is not
// finite, limits and ticks not above zero, a move of more than kMaxDurationTicks. Cost: at most kMaxRootSteps + 8
// evaluations of a stop, about two square roots each; 10 for usual moves, 141 the most of 300,000 over six decades.
Status plan_from(const StartMotion& start, double distance, const AxisLimits& limits, double tick_s, Plan& out);

// Plans to `velocity` (signed, unit/s, within its limit) and no acceleration, in the least time; the rest of the last
// tick is at that velocity. `out.distance` is where it leads to. Same limits and refusals; closed form.
Status plan_to_velocity(const StartMotion& start, double velocity, const AxisLimits& limits, double tick_s, Plan& out);

constexpr int kMaxRootSteps = 200;

}  // namespace stillpoint
