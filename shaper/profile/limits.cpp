// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/limits.hpp"

namespace stillpoint {

namespace {

constexpr unsigned kCount = 6;

constexpr Quantity kQuantities[kCount] = {Quantity::kVelocity, Quantity::kAcceleration,     Quantity::kDeceleration,
                                          Quantity::kJerk,     Quantity::kDecelerationJerk, Quantity::kTick};

struct Values {
  double value[kCount];
  [[gnu::noinline]] Values(const AxisLimits& l, double tick_s)
      : value{l.velocity, l.acceleration, l.deceleration, l.jerk, l.braking_jerk(), tick_s} {}
};

}  // namespace

Status AxisLimits::validate(double tick_s) const {
  const Values values(*this, tick_s);
  Status status;
  for (unsigned i = 0; i < kCount && status.ok(); ++i) status = check_positive(kQuantities[i], values.value[i]);
  return status;
}

Status AxisLimits::validate() const { return validate(1.0); }

Status AxisLimits::within(const AxisLimits& maximum) const {
  const Values values(*this, 1.0);
  const Values most(maximum, 1.0);
  for (unsigned i = 0; i < kCount; ++i) {
    if (values.value[i] > most.value[i])
      return refuse(Error::kAboveMaximum, kQuantities[i], values.value[i], most.value[i]);
  }
  return kOk;
}

}  // namespace stillpoint
