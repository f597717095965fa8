// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/stop_ramp.hpp"

#include "shaper/base/math.hpp"
#include "shaper/profile/braking.hpp"
#include "shaper/profile/lsb_limit.hpp"

namespace stillpoint {

Status StopLimits::make(double deceleration, double jerk, double tick_s, StopLimits& out) {
  Status status = check_positive(Quantity::kTick, tick_s);
  if (!status.ok()) return status;
  const double per_tick_2 = tick_s * tick_s * static_cast<double>(kSignalPerCount);
  constexpr int64_t kMost = kMotionLimit - 1;
  StopLimits made{};
  status = limit_in_lsb(Quantity::kDeceleration, deceleration, per_tick_2, 1, kMost, made.deceleration);
  if (status.ok()) status = limit_in_lsb(Quantity::kJerk, jerk, per_tick_2 * tick_s, 1, kMost, made.jerk);
  if (status.ok()) out = made;
  return status;
}

void StopRamp::start(const StopLimits& limits, Signal newest, Signal before, Signal before_that) {
  limits_ = limits;
  position_ = newest;
  velocity_ = wrapping_difference(newest, before);
  acceleration_ = wrapping_difference(velocity_, wrapping_difference(before, before_that));
}

Signal StopRamp::tick() {
  const int64_t signed_velocity = within_motion_limit(velocity_);
  const int64_t acceleration = within_motion_limit(acceleration_);
  const bool forward = signed_velocity >= 0;
  const int64_t velocity = forward ? signed_velocity : -signed_velocity;
  const int64_t braking = forward ? -acceleration : acceleration;
  const int64_t next = next_braking(velocity, braking, limits_.deceleration, limits_.jerk, limits_.jerk);
  const int64_t left = velocity - next;
  acceleration_ = forward ? -next : next;
  velocity_ = forward ? left : -left;
  position_ = wrapping_sum(position_, velocity_);
  return position_;
}

}  // namespace stillpoint
