// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/zero_delay.hpp"

#include <float.h>

namespace stillpoint {

Quantity sustained_limit(const Plan& plan, uint32_t length_ticks) {
  Quantity limit = Quantity::kNone;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& segment = plan.segments[i];
    if (segment.duration_ticks <= length_ticks + 3.0) continue;  // a third difference spans three ticks more
    if (segment.jerk != 0.0) {
      if (limit == Quantity::kNone) limit = Quantity::kJerk;
    } else if (segment.acceleration == 0.0) {
      return Quantity::kVelocity;
    } else {
      limit = (segment.acceleration > 0.0) == (plan.distance > 0.0) ? Quantity::kAcceleration : Quantity::kDeceleration;
    }
  }
  return limit;
}

ShapedMoveCheck::ShapedMoveCheck(const Plan& plan, const AxisLimits& limits, bool jerk_limited, double tick_s,
                                 Shaper& scratch, Track& track, Signal start, Signal target)
    : plan_(plan), scratch_(scratch), track_(track), start_(start), target_(target), limit_{} {
  // Each rounding to the LSB, the profile's and one a stage, adds up to 1, 2, 4 LSB to the differences.
  const double roundings = scratch.stage_count() + 1.0;
  const double lsb_tick = tick_s * static_cast<double>(kSignalPerCount);
  limit_[0] = limits.velocity * lsb_tick + roundings;
  limit_[1] = limits.acceleration * lsb_tick * tick_s + 2.0 * roundings;
  limit_[2] = limits.deceleration * lsb_tick * tick_s + 2.0 * roundings;
  limit_[3] = jerk_limited ? limits.jerk * lsb_tick * tick_s * tick_s + 4.0 * roundings : DBL_MAX;
}

Quantity ShapedMoveCheck::broken_at(uint32_t profile_ticks) {
  if (!stretch(plan_, profile_ticks).ok()) return Quantity::kDuration;
  Track::make(plan_, start_, target_, track_);
  scratch_.fill(start_);
  Sampler sampler;
  sampler.begin(track_);
  const bool forward = target_ >= start_;
  Signal last = start_;
  int64_t velocity = 0;
  int64_t acceleration = 0;
  // Three ticks more than the stream moves: its differences come to rest.
  const uint32_t ticks = profile_ticks + scratch_.length_ticks() + 3;
  for (uint32_t i = 0; i < ticks; ++i) {
    const Signal output = scratch_.tick(sampler.tick());
    const int64_t step = forward ? output - last : last - output;
    const int64_t change = step - velocity;
    const double jerk = static_cast<double>(change) - static_cast<double>(acceleration);
    last = output;
    velocity = step;
    acceleration = change;
    const double step_d = static_cast<double>(step);
    const double change_d = static_cast<double>(change);
    if (step_d > limit_[0] || -step_d > limit_[0]) return Quantity::kVelocity;
    if (change_d > limit_[1]) return Quantity::kAcceleration;
    if (-change_d > limit_[2]) return Quantity::kDeceleration;
    if (jerk > limit_[3] || -jerk > limit_[3]) return Quantity::kJerk;
  }
  return Quantity::kNone;
}

uint32_t ShapedMoveCheck::least_ticks(uint32_t too_short, uint32_t enough, Quantity& binding) {
  if (enough > kLongestSearchTicks) return enough;
  while (enough - too_short > 1) {
    const uint32_t middle = too_short + (enough - too_short) / 2;
    const Quantity broken = broken_at(middle);
    if (broken == Quantity::kNone) {
      enough = middle;
    } else {
      too_short = middle;
      binding = broken;
    }
  }
  return enough;
}

uint32_t ShapedMoveCheck::least_slowed_ticks(uint32_t from, uint32_t enough) {
  Quantity binding = broken_at(from);
  if (binding == Quantity::kNone) return from;
  if (enough <= kLongestSearchTicks) return least_ticks(from, enough, binding);
  constexpr uint32_t kPercent[] = {101, 103, 110, 130, 170};
  for (size_t i = 0; i < sizeof kPercent / sizeof kPercent[0]; ++i) {
    const uint32_t ticks = from / 100 * kPercent[i] + from % 100 * kPercent[i] / 100;
    if (ticks < enough && broken_at(ticks) == Quantity::kNone) return ticks;
  }
  return enough;
}

}  // namespace stillpoint
