// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/axis_config.hpp"

#include "shaper/base/math.hpp"
#include "shaper/profile/stop_ramp.hpp"

namespace stillpoint {

Status AxisConfig::validate() const {
  const Status status = maximum.validate();
  if (!status.ok()) return status;
  if (modulo_counts > kMaxModuloCounts)
    return refuse(Error::kAboveMaximum, Quantity::kPosition, modulo_counts, kMaxModuloCounts);
  if (modulo_counts != 0 && has_soft_limits())
    return refuse(Error::kNotAvailable, Quantity::kPosition, soft_high_counts, soft_low_counts);
  StopLimits unused{};
  return StopLimits::make(quick_stop_deceleration, quick_stop_jerk, tick_s, unused);
}

const char* text(MoveTiming timing) {
  switch (timing) {
    case MoveTiming::kPlain: return "plain";
    case MoveTiming::kSlowed: return "slowed";
    case MoveTiming::kWithin: return "within";
    case MoveTiming::kSpedUp: return "sped-up";
    case MoveTiming::kScaled: return "scaled";
    case MoveTiming::kRaised: return "raised";
  }
  return "";
}

}  // namespace stillpoint
