// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/mode.hpp"

#include <float.h>

#include "shaper/base/math.hpp"

namespace stillpoint {

Status Mode::validate() const {
  if (!math::is_finite(frequency_hz)) return refuse(Error::kNotFinite, Quantity::kFrequency, frequency_hz);
  if (!(frequency_hz > 0.0)) return refuse(Error::kNotPositive, Quantity::kFrequency, frequency_hz);
  if (!math::is_finite(damping_ratio)) return refuse(Error::kNotFinite, Quantity::kDampingRatio, damping_ratio);
  if (damping_ratio < 0.0) return refuse(Error::kBelowMinimum, Quantity::kDampingRatio, damping_ratio, 0.0);
  if (damping_ratio >= 1.0)
    return refuse(Error::kAboveMaximum, Quantity::kDampingRatio, damping_ratio, 1.0 - DBL_EPSILON);
  return kOk;
}

}  // namespace stillpoint
