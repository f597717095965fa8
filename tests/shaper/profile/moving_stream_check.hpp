// SPDX-License-Identifier: Apache-2.0
// Watches a setpoint stream that begins in motion and may turn round.
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/profile/limits.hpp"

namespace stillpoint::testing {

// The worst that a stream's differences exceed its limits by, in LSB of the signal. A difference counts once all the
// samples in it are the plan's; where the velocity changes its sign among them, the larger limits of acceleration and
// jerk hold, and so they do everywhere behind a shaper, where what is yet to speed up and what slows down already come
// together. Positions may wrap.
class MovingStreamCheck {
 public:
  MovingStreamCheck(Signal start, const AxisLimits& limits, double tick_s, uint32_t stages = 0)
      : tick_s_(tick_s), stages_(stages) {
    last_[0] = start;
    change_limits(limits);
  }

  void change_limits(const AxisLimits& limits) {
    const double tick_2 = tick_s_ * tick_s_;
    velocity_limit_ = limits.velocity * tick_s_ * kLsb;
    acceleration_limit_ = limits.acceleration * tick_2 * kLsb;
    deceleration_limit_ = limits.deceleration * tick_2 * kLsb;
    jerk_limit_ = limits.jerk * tick_2 * tick_s_ * kLsb;
    braking_jerk_limit_ = limits.braking_jerk() * tick_2 * tick_s_ * kLsb;
  }

  void next(Signal signal) {
    for (int i = 3; i > 0; --i) last_[i] = last_[i - 1];
    last_[0] = signal;
    ++samples_;
    const int64_t v = step(0);
    if (samples_ >= 1) raise(velocity_excess, magnitude(v) - velocity_limit_);
    if (samples_ >= 2) check_acceleration(v, step(1));
    if (samples_ >= 3) check_jerk(v - step(1), step(1) - step(2), v);
  }

  // design.md 8.
  bool within() const {
    const double roundings = stages_ + 1.0;
    return velocity_excess <= roundings && acceleration_excess <= 2.0 * roundings && jerk_excess <= 4.0 * roundings;
  }

  double velocity_excess = -1e300;
  double acceleration_excess = -1e300;
  double jerk_excess = -1e300;

 private:
  static constexpr double kLsb = 4294967296.0;

  static double magnitude(int64_t value) {
    return value < 0 ? -static_cast<double>(value) : static_cast<double>(value);
  }
  static double larger(double a, double b) { return a > b ? a : b; }
  static void raise(double& worst, double value) {
    if (value > worst) worst = value;
  }
  int64_t step(int i) const {
    return static_cast<int64_t>(static_cast<uint64_t>(last_[i]) - static_cast<uint64_t>(last_[i + 1]));
  }

  // The velocity keeps its sign for sure between two steps of the same sign whose acceleration turns neither to zero.
  void check_acceleration(int64_t v, int64_t before) {
    const double most = larger(acceleration_limit_, deceleration_limit_);
    const double change = magnitude(v - before);
    const bool turns = stages_ != 0 || (v > 0) != (before > 0) || magnitude(v) < most || magnitude(before) < most;
    const bool speeds_up = (v > before) == (v > 0);
    raise(acceleration_excess, change - (turns ? most : (speeds_up ? acceleration_limit_ : deceleration_limit_)));
  }

  // It speeds up or slows down for sure throughout where both accelerations have one sign and the velocity's is safe.
  void check_jerk(int64_t acceleration, int64_t before, int64_t v) {
    const double most = larger(jerk_limit_, braking_jerk_limit_);
    const bool one_sign = stages_ == 0 && (acceleration > 0) == (before > 0) && magnitude(acceleration) > most &&
                          magnitude(before) > most &&
                          magnitude(v) > 3.0 * larger(acceleration_limit_, deceleration_limit_);
    const bool speeds_up = (acceleration > 0) == (v > 0);
    const double limit = one_sign ? (speeds_up ? jerk_limit_ : braking_jerk_limit_) : most;
    raise(jerk_excess, magnitude(acceleration - before) - limit);
  }

  double tick_s_;
  uint32_t stages_;
  double velocity_limit_ = 0.0;
  double acceleration_limit_ = 0.0;
  double deceleration_limit_ = 0.0;
  double jerk_limit_ = 0.0;
  double braking_jerk_limit_ = 0.0;
  Signal last_[4] = {};
  int samples_ = 0;
};

}  // namespace stillpoint::testing
