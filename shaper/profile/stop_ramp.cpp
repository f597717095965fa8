// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/stop_ramp.hpp"

#include "shaper/base/math.hpp"
#include "shaper/profile/braking.hpp"

namespace stillpoint {

namespace {

constexpr double kLargest = 4.0e18;  // below kMotionLimit

Status check(Quantity quantity, double value) {
  if (!math::is_finite(value)) return refuse(Error::kNotFinite, quantity, value);
  if (!(value > 0.0)) return refuse(Error::kNotPositive, quantity, value);
  return kOk;
}

// In whole LSB, rounded up; `unit` LSB are 1.
Status to_lsb(Quantity quantity, double value, double unit, int64_t& lsb) {
  const Status status = check(quantity, value);
  if (!status.ok()) return status;
  const double exact = value * unit;
  if (exact < 1.0) return refuse(Error::kBelowMinimum, quantity, value, 1.0 / unit);
  lsb = static_cast<int64_t>(exact < kLargest ? exact : kLargest);
  if (static_cast<double>(lsb) < exact && exact < kLargest) ++lsb;
  return kOk;
}

int64_t below_motion_limit(int64_t value) {
  constexpr int64_t kMost = kMotionLimit - 1;
  return value > kMost ? kMost : value < -kMost ? -kMost : value;
}

}  // namespace

Status StopLimits::make(double deceleration, double jerk, double tick_s, StopLimits& out) {
  StopLimits made{};
  Status status = check(Quantity::kTick, tick_s);
  const double per_tick_2 = tick_s * tick_s * static_cast<double>(kSignalPerCount);
  if (status.ok()) status = to_lsb(Quantity::kDeceleration, deceleration, per_tick_2, made.deceleration);
  if (status.ok()) status = to_lsb(Quantity::kJerk, jerk, per_tick_2 * tick_s, made.jerk);
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
  const int64_t signed_velocity = below_motion_limit(velocity_);
  const int64_t acceleration = below_motion_limit(acceleration_);
  const bool forward = signed_velocity >= 0;
  const int64_t velocity = forward ? signed_velocity : -signed_velocity;
  const int64_t braking = forward ? -acceleration : acceleration;
  const int64_t next = next_braking(velocity, braking, limits_.deceleration, limits_.jerk);
  const int64_t left = velocity - next;
  acceleration_ = forward ? -next : next;
  velocity_ = forward ? left : -left;
  position_ = wrapping_sum(position_, velocity_);
  return position_;
}

}  // namespace stillpoint
