// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/mode.hpp"

#include <float.h>

#include "shaper/base/math.hpp"

namespace stillpoint {

Status Mode::validate() const {
  Status status = check_positive(Quantity::kFrequency, frequency_hz);
  if (status.ok()) status = check_finite(Quantity::kDampingRatio, damping_ratio);
  if (!status.ok()) return status;
  if (damping_ratio < 0.0) return refuse(Error::kBelowMinimum, Quantity::kDampingRatio, damping_ratio, 0.0);
  if (damping_ratio >= 1.0)
    return refuse(Error::kAboveMaximum, Quantity::kDampingRatio, damping_ratio, 1.0 - DBL_EPSILON);
  return kOk;
}

}  // namespace stillpoint
