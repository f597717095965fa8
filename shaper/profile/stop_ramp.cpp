// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/stop_ramp.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr double kLargest = 4.0e18;  // below 2^62: sums of two still fit

Status check(Quantity quantity, double value) {
  if (!math::is_finite(value)) return refuse(Error::kNotFinite, quantity, value);
  if (!(value > 0.0)) return refuse(Error::kNotPositive, quantity, value);
  return kOk;
}

double at_most(double value, double limit) { return value < limit ? value : limit; }

}  // namespace

Status StopLimits::make(double deceleration, double jerk, double tick_s, StopLimits& out) {
  Status status = check(Quantity::kDeceleration, deceleration);
  if (status.ok()) status = check(Quantity::kJerk, jerk);
  if (status.ok()) status = check(Quantity::kTick, tick_s);
  if (!status.ok()) return status;
  const double per_tick_2 = tick_s * tick_s * static_cast<double>(kSignalPerCount);
  const double deceleration_lsb = at_most(deceleration * per_tick_2, kLargest);
  const double jerk_lsb = at_most(jerk * per_tick_2 * tick_s, kLargest);
  if (deceleration_lsb < 1.0)
    return refuse(Error::kBelowMinimum, Quantity::kDeceleration, deceleration, 1.0 / per_tick_2);
  if (jerk_lsb < 1.0) return refuse(Error::kBelowMinimum, Quantity::kJerk, jerk, 1.0 / (per_tick_2 * tick_s));
  const double whole = math::floor(deceleration_lsb);  // at least as many LSB as levels
  const double levels = math::ceil(whole / jerk_lsb);
  out.jerk_step = static_cast<int64_t>(whole / levels);
  out.deceleration = out.jerk_step * static_cast<int64_t>(levels);
  return kOk;
}

void StopRamp::start(const StopLimits& limits, Signal newest, Signal before, Signal before_that) {
  limits_ = limits;
  position_ = newest;
  velocity_ = newest - before;
  acceleration_ = velocity_ - (before - before_that);
  level_ = -1;
}

// In the frame where the velocity is positive: how hard to brake in this tick. See the header for the rule.
int64_t StopRamp::next_braking(int64_t velocity, int64_t braking) {
  const int64_t step = limits_.jerk_step;
  if (braking < 0) {  // still speeding up: that ends first
    level_ = -1;
    return braking + step < 0 ? braking + step : 0;
  }
  if (braking > limits_.deceleration) {
    level_ = -1;
    return braking - step > limits_.deceleration ? braking - step : limits_.deceleration;
  }
  if (braking <= step && velocity <= step) {  // what is left goes in one tick, and the braking in the next
    level_ = -1;
    return velocity;
  }
  if (level_ < 0) return align(velocity, braking);
  const int64_t up = braking + step;
  if (up <= limits_.deceleration && velocity - up >= release_ + braking) {
    release_ += braking;
    ++level_;
    return up;
  }
  if (velocity - braking >= release_ && braking > 0) return braking;
  if (level_ == 0) return 0;
  --level_;
  release_ -= braking - step;
  return braking - step;
}

// From braking between two levels of the lattice to the higher one if the velocity is enough for it, else the lower.
int64_t StopRamp::align(int64_t velocity, int64_t braking) {
  const int64_t step = limits_.jerk_step;
  int64_t below = 0;
  int64_t level = 0;
  for (int bit = 40; bit >= 0; --bit) {
    if (step > (braking - below) >> bit) continue;
    below += step << bit;
    level += INT64_C(1) << bit;
  }
  // Velocity that letting go from `below` gives back: the levels under it. Past 2^62 no velocity is enough.
  const auto sum_below = [step](int64_t n) {
    constexpr int64_t kTooMuch = INT64_C(1) << 62;
    const int64_t pairs = n < (INT64_C(1) << 31) ? n * (n - 1) / 2 : kTooMuch;
    int64_t product = 0;
    return n < 2 ? INT64_C(0)
                 : (__builtin_mul_overflow(pairs, step, &product) || product > kTooMuch ? kTooMuch : product);
  };
  const int64_t above = below + step;
  const bool reaches = above <= limits_.deceleration && velocity - above >= sum_below(level + 1);
  level_ = reaches ? level + 1 : level;
  release_ = sum_below(level_);
  return reaches ? above : below;
}

Signal StopRamp::tick() {
  if (at_rest()) return position_;
  // With no velocity left it is the acceleration that has to be undone, as if it were speeding up.
  const bool forward = velocity_ > 0 || (velocity_ == 0 && acceleration_ > 0);
  const int64_t velocity = forward ? velocity_ : -velocity_;
  const int64_t braking = forward ? -acceleration_ : acceleration_;
  const int64_t next = next_braking(velocity, braking);
  acceleration_ = forward ? -next : next;
  velocity_ += acceleration_;
  if (__builtin_add_overflow(position_, velocity_, &position_)) {  // the end of the position range: stand there
    position_ = velocity_ > 0 ? signal_from_counts(kMaxPositionCounts) : signal_from_counts(kMinPositionCounts);
    velocity_ = 0;
    acceleration_ = 0;
  }
  return position_;
}

}  // namespace stillpoint
