// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/zero_delay.hpp"

#include <float.h>

#include "shaper/axis/turns.hpp"

namespace stillpoint {

namespace {

template <typename Number>
void raise(Number& peak, Number value) {
  if (value > peak) peak = value;
}

}  // namespace

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

ShapedMoveCheck::ShapedMoveCheck(const AxisLimits& limits, bool jerk_limited, double tick_s, Shaper& scratch,
                                 Track& track, Signal start, Signal target)
    : scratch_(scratch), track_(track), start_(start), target_(target), tick_s_(tick_s), limit_{} {
  // Each rounding to the LSB, the profile's and one a stage, adds up to 1, 2, 4 LSB to the differences.
  const double roundings = scratch.stage_count() + 1.0;
  const double lsb_tick = tick_s * static_cast<double>(kSignalPerCount);
  const double lsb_tick_3 = lsb_tick * tick_s * tick_s;
  limit_[0] = limits.velocity * lsb_tick + roundings;
  limit_[1] = limits.acceleration * lsb_tick * tick_s + 2.0 * roundings;
  limit_[2] = limits.deceleration * lsb_tick * tick_s + 2.0 * roundings;
  limit_[3] = jerk_limited ? limits.larger_jerk() * lsb_tick_3 + 4.0 * roundings : DBL_MAX;
}

Quantity ShapedMoveCheck::broken(const Plan& plan) {
  Track::make(plan, start_, target_, track_);
  scratch_.fill(start_);
  Sampler sampler;
  sampler.begin(track_);
  const bool forward = wrapping_difference(target_, start_) >= 0;
  Signal last = start_;
  int64_t velocity = 0;
  int64_t acceleration = 0;
  Extremes extremes{};
  // Three ticks more than the stream moves: its differences come to rest.
  const uint32_t ticks = plan.duration_ticks + scratch_.length_ticks() + 3;
  for (uint32_t i = 0; i < ticks; ++i) {
    const Signal output = scratch_.tick(sampler.tick());
    const int64_t step = forward ? wrapping_difference(output, last) : wrapping_difference(last, output);
    const int64_t change = step - velocity;
    const double jerk = static_cast<double>(change) - static_cast<double>(acceleration);
    last = output;
    velocity = step;
    acceleration = change;
    raise(extremes.velocity, step);
    raise(extremes.velocity, -step);
    raise(extremes.acceleration, change);
    raise(extremes.deceleration, -change);
    raise(extremes.jerk, jerk);
    raise(extremes.jerk, -jerk);
    if (static_cast<double>(extremes.velocity) > limit_[0]) return Quantity::kVelocity;
    if (static_cast<double>(extremes.acceleration) > limit_[1]) return Quantity::kAcceleration;
    if (static_cast<double>(extremes.deceleration) > limit_[2]) return Quantity::kDeceleration;
    if (extremes.jerk > limit_[3]) return Quantity::kJerk;
  }
  note(extremes);
  return Quantity::kNone;
}

void ShapedMoveCheck::note(const Extremes& extremes) {
  const double per_tick = 1.0 / (tick_s_ * static_cast<double>(kSignalPerCount));
  const double up = static_cast<double>(extremes.acceleration);
  const double down = static_cast<double>(extremes.deceleration);
  peaks_.velocity = static_cast<double>(extremes.velocity) * per_tick;
  peaks_.acceleration = (up > down ? up : down) * per_tick / tick_s_;
  peaks_.jerk = limit_[3] == DBL_MAX ? 0.0 : extremes.jerk * per_tick / (tick_s_ * tick_s_);
  use_ = 0.0;
  raise(use_, static_cast<double>(extremes.velocity) / limit_[0]);
  raise(use_, up / limit_[1]);
  raise(use_, down / limit_[2]);
  raise(use_, extremes.jerk / limit_[3]);
}

Quantity ShapedMoveCheck::broken_at(const Plan& plan, uint32_t profile_ticks) {
  Plan stretched = plan;
  return stretch(stretched, profile_ticks).ok() ? broken(stretched) : Quantity::kDuration;
}

uint32_t ShapedMoveCheck::least_ticks(const Plan& plan, uint32_t too_short, uint32_t enough, Quantity& binding) {
  if (enough > kLongestSearchTicks) return enough;
  while (enough - too_short > 1) {
    const uint32_t middle = too_short + (enough - too_short) / 2;
    const Quantity broken = broken_at(plan, middle);
    if (broken == Quantity::kNone) {
      enough = middle;
    } else {
      too_short = middle;
      binding = broken;
    }
  }
  return enough;
}

uint32_t ShapedMoveCheck::least_slowed_ticks(const Plan& plan, uint32_t from, uint32_t enough) {
  Quantity binding = broken_at(plan, from);
  if (binding == Quantity::kNone) return from;
  if (enough <= kLongestSearchTicks) return least_ticks(plan, from, enough, binding);
  static constexpr uint32_t kPercent[] = {101, 103, 110, 130, 170};
  for (size_t i = 0; i < sizeof kPercent / sizeof kPercent[0]; ++i) {
    const uint32_t ticks = from / 100 * kPercent[i] + from % 100 * kPercent[i] / 100;
    if (ticks < enough && broken_at(plan, ticks) == Quantity::kNone) return ticks;
  }
  return enough;
}

}  // namespace stillpoint
