// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/extent.hpp"

#include "shaper/base/math.hpp"
#include "shaper/profile/velocity_transition.hpp"

namespace stillpoint {

namespace {

[[gnu::noinline]] void widen(Extent& extent, double position) {
  if (position < extent.lowest) extent.lowest = position;
  if (position > extent.highest) extent.highest = position;
}

// Where the motion turns round within a segment it is at rest for a moment: v + a t + j t^2/2 = 0.
void widen_at_turns(Extent& extent, const Motion& from, const Segment& segment) {
  const double square = from.acceleration * from.acceleration - 2.0 * segment.jerk * from.velocity;
  if (square < 0.0) return;
  // Of the two roots q/j and 2v/q: no difference of equal numbers.
  const double q = -(from.acceleration + math::copysign(math::sqrt(square), from.acceleration));
  const double turns[2] = {segment.jerk != 0.0 ? q / segment.jerk : -1.0, q != 0.0 ? 2.0 * from.velocity / q : -1.0};
  for (int i = 0; i < 2; ++i) {
    if (turns[i] > 0.0 && turns[i] < segment.duration_ticks)
      widen(extent, advanced(from, segment.jerk, turns[i]).position);
  }
}

}  // namespace

Extent extent_of(const Plan& plan) {
  Extent extent{0.0, 0.0};
  Motion motion{0.0, plan.start_velocity, 0.0};
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& segment = plan.segments[i];
    motion.acceleration = segment.acceleration;
    widen_at_turns(extent, motion, segment);
    motion = advanced(motion, segment.jerk, segment.duration_ticks);
    widen(extent, motion.position);
  }
  return extent;
}

}  // namespace stillpoint
