// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/stream_limits.hpp"

#include "shaper/base/math.hpp"
#include "shaper/base/signal.hpp"
#include "shaper/profile/lsb_limit.hpp"

namespace stillpoint {

// A velocity within V changes by at most 2V, an acceleration within 2V by 4V: what is above limits nothing.
Status StreamLimits::make(const AxisLimits& limits, double tick_s, StreamLimits& out) {
  Status status = limits.validate(tick_s);
  if (!status.ok()) return status;
  const double per_tick = tick_s * static_cast<double>(kSignalPerCount);
  const double per_tick_2 = per_tick * tick_s;
  const double per_tick_3 = per_tick_2 * tick_s;
  StreamLimits made{};
  status = limit_in_lsb(Quantity::kVelocity, limits.velocity, per_tick, 1, ApproachCurve::kMaxVelocity, made.velocity);
  const int64_t twice = 2 * made.velocity;
  if (status.ok())
    status = limit_in_lsb(Quantity::kAcceleration, limits.acceleration, per_tick_2, 2, twice, made.acceleration);
  if (status.ok())
    status = limit_in_lsb(Quantity::kDeceleration, limits.deceleration, per_tick_2, 2, twice, made.deceleration);
  if (status.ok()) status = limit_in_lsb(Quantity::kJerk, limits.larger_jerk(), per_tick_3, 4, 2 * twice, made.jerk);
  if (!status.ok()) return status;
  made.curve = ApproachCurve::make(made.velocity, made.deceleration, made.jerk);
  made.soft_curve = ApproachCurve::make(made.velocity, made.smaller_acceleration(), made.jerk);
  out = made;
  return status;
}

}  // namespace stillpoint
