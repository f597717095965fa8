// SPDX-License-Identifier: Apache-2.0
// Random moves of random arms, as a machine may have them.
#pragma once

#include <cmath>

#include "shaper/profile/limits.hpp"
#include "shaper/shaping/mode.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

struct RandomTask {
  int32_t distance_counts;
  AxisLimits limits;  // counts/s^n
  Mode mode;
};

// A mode of 3 to 60 Hz, damping to 0.2; the ramps take a third to thirty periods, the jerk from a twentieth of them to
// all, the move from a tenth of a ramp to three times what the ramps cover. Half are asymmetric.
inline RandomTask random_task(Random& random) {
  const auto log_between = [&](double low, double high) { return low * std::pow(high / low, random.unit()); };
  RandomTask out{};
  out.mode = Mode{log_between(3.0, 60.0), random.unit() < 0.2 ? 0.0 : random.between(0.0, 0.2)};
  const double velocity = 1e6 * log_between(0.1, 4.0);
  const double ramp_s = log_between(0.3, 10.0) / out.mode.frequency_hz;
  AxisLimits& limits = out.limits;
  limits.velocity = velocity;
  limits.acceleration = velocity / ramp_s;
  limits.deceleration = limits.acceleration * (random.unit() < 0.5 ? 1.0 : log_between(0.5, 2.0));
  limits.jerk = limits.acceleration / (ramp_s * log_between(0.05, 1.0));
  const double distance = velocity * ramp_s * log_between(0.05, 3.0);
  out.distance_counts = static_cast<int32_t>(random.unit() < 0.5 ? distance : -distance);
  return out;
}

}  // namespace stillpoint::testing
