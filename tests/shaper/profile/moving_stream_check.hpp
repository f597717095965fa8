// SPDX-License-Identifier: Apache-2.0
// Watches a setpoint stream that begins in motion and may turn round.
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/profile/limits.hpp"

namespace stillpoint::testing {

// The worst that a stream's differences exceed its limits by, in LSB of the signal. A difference counts once all the
// samples in it are the plan's; where the velocity changes its sign among them, the larger acceleration limit holds.
class MovingStreamCheck {
 public:
  MovingStreamCheck(Signal start, const AxisLimits& limits, double tick_s)
      : velocity_limit_(limits.velocity * tick_s * kLsb),
        acceleration_limit_(limits.acceleration * tick_s * tick_s * kLsb),
        deceleration_limit_(limits.deceleration * tick_s * tick_s * kLsb),
        jerk_limit_(limits.jerk * tick_s * tick_s * tick_s * kLsb),
        braking_jerk_limit_(limits.braking_jerk() * tick_s * tick_s * tick_s * kLsb) {
    last_[0] = start;
  }

  void next(Signal signal) {
    for (int i = 3; i > 0; --i) last_[i] = last_[i - 1];
    last_[0] = signal;
    ++samples_;
    const int64_t v = last_[0] - last_[1];
    if (samples_ >= 1) raise(velocity_excess, magnitude(v) - velocity_limit_);
    if (samples_ >= 2) check_acceleration(v, last_[1] - last_[2]);
    if (samples_ >= 3) check_jerk(v - (last_[1] - last_[2]), (last_[1] - last_[2]) - (last_[2] - last_[3]), v);
  }

  // design.md 8, with no stage behind the profile.
  bool within() const { return velocity_excess <= 1.0 && acceleration_excess <= 2.0 && jerk_excess <= 4.0; }

  double velocity_excess = -1e300;
  double acceleration_excess = -1e300;
  double jerk_excess = -1e300;

 private:
  static constexpr double kLsb = 4294967296.0;

  static double magnitude(int64_t value) {
    return value < 0 ? -static_cast<double>(value) : static_cast<double>(value);
  }
  static void raise(double& worst, double value) {
    if (value > worst) worst = value;
  }

  // The velocity keeps its sign for sure between two steps of the same sign whose acceleration turns neither to zero.
  void check_acceleration(int64_t v, int64_t before) {
    const double larger = acceleration_limit_ > deceleration_limit_ ? acceleration_limit_ : deceleration_limit_;
    const double change = magnitude(v - before);
    const bool turns = (v > 0) != (before > 0) || magnitude(v) < larger || magnitude(before) < larger;
    const bool speeds_up = (v > before) == (v > 0);
    raise(acceleration_excess, change - (turns ? larger : (speeds_up ? acceleration_limit_ : deceleration_limit_)));
  }

  // It speeds up or slows down for sure throughout where both accelerations have one sign and the velocity's is safe.
  void check_jerk(int64_t acceleration, int64_t before, int64_t v) {
    const double larger = jerk_limit_ > braking_jerk_limit_ ? jerk_limit_ : braking_jerk_limit_;
    const double most = acceleration_limit_ > deceleration_limit_ ? acceleration_limit_ : deceleration_limit_;
    const bool one_sign = (acceleration > 0) == (before > 0) && magnitude(acceleration) > larger &&
                          magnitude(before) > larger && magnitude(v) > 3.0 * most;
    const bool speeds_up = (acceleration > 0) == (v > 0);
    const double limit = one_sign ? (speeds_up ? jerk_limit_ : braking_jerk_limit_) : larger;
    raise(jerk_excess, magnitude(acceleration - before) - limit);
  }

  double velocity_limit_;
  double acceleration_limit_;
  double deceleration_limit_;
  double jerk_limit_;
  double braking_jerk_limit_;
  Signal last_[4] = {};
  int samples_ = 0;
};

}  // namespace stillpoint::testing
