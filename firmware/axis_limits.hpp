// SPDX-License-Identifier: Apache-2.0
// The axis's limits as their registers have them.
#pragma once

#include "firmware/parameters.hpp"
#include "shaper/axis/axis_config.hpp"

namespace stillpoint::firmware {

// `get`: a register's value, the type's own bits. What has no register stays.
template <typename Get>
void take_axis_limits(const Get& get, AxisConfig& config) {
  config.maximum.velocity = get(Register::kMaximumVelocity);
  config.maximum.acceleration = get(Register::kMaximumAcceleration);
  config.maximum.deceleration = config.maximum.acceleration;
  config.maximum.jerk = get(Register::kMaximumJerk) * kJerkUnit;
  config.quick_stop_deceleration = get(Register::kQuickStopDeceleration);
  config.quick_stop_jerk = get(Register::kQuickStopJerk) * kJerkUnit;
  config.soft_low_counts = static_cast<int32_t>(get(Register::kSoftLimitLow));
  config.soft_high_counts = static_cast<int32_t>(get(Register::kSoftLimitHigh));
}

}  // namespace stillpoint::firmware
