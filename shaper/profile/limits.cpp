// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/limits.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

struct NamedLimit {
  Quantity quantity;
  double value;
};

Status validate_one(NamedLimit limit) {
  if (!math::is_finite(limit.value)) return refuse(Error::kNotFinite, limit.quantity, limit.value);
  if (!(limit.value > 0.0)) return refuse(Error::kNotPositive, limit.quantity, limit.value);
  return kOk;
}

}  // namespace

Status AxisLimits::validate() const {
  const NamedLimit limits[] = {{Quantity::kVelocity, velocity},
                               {Quantity::kAcceleration, acceleration},
                               {Quantity::kDeceleration, deceleration},
                               {Quantity::kJerk, jerk},
                               {Quantity::kDecelerationJerk, braking_jerk()}};
  for (unsigned i = 0; i < sizeof limits / sizeof limits[0]; ++i) {
    const Status status = validate_one(limits[i]);
    if (!status.ok()) return status;
  }
  return kOk;
}

Status AxisLimits::within(const AxisLimits& maximum) const {
  if (velocity > maximum.velocity) return refuse(Error::kAboveMaximum, Quantity::kVelocity, velocity, maximum.velocity);
  if (acceleration > maximum.acceleration)
    return refuse(Error::kAboveMaximum, Quantity::kAcceleration, acceleration, maximum.acceleration);
  if (deceleration > maximum.deceleration)
    return refuse(Error::kAboveMaximum, Quantity::kDeceleration, deceleration, maximum.deceleration);
  if (jerk > maximum.jerk) return refuse(Error::kAboveMaximum, Quantity::kJerk, jerk, maximum.jerk);
  if (braking_jerk() > maximum.braking_jerk())
    return refuse(Error::kAboveMaximum, Quantity::kDecelerationJerk, braking_jerk(), maximum.braking_jerk());
  return kOk;
}

}  // namespace stillpoint
