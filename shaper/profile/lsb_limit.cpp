// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/lsb_limit.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

Status limit_in_lsb(Quantity quantity, double value, double lsb_per_unit, int64_t rounding, int64_t most,
                    int64_t& lsb) {
  const Status status = check_positive(quantity, value);
  if (!status.ok()) return status;
  const double exact = value * lsb_per_unit;
  if (exact < 1.0) return refuse(Error::kBelowMinimum, quantity, value, 1.0 / lsb_per_unit);
  lsb = exact < static_cast<double>(most - rounding) ? static_cast<int64_t>(exact) + rounding : most;
  return kOk;
}

}  // namespace stillpoint
