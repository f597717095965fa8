// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/math.hpp"

namespace stillpoint::math {

double sqrt_out_of_line(double x) {
  if (x == 0.0 || x == kInfinity) return x;
  return x > 0.0 ? sqrt_in_integers(x) : kNan;
}

}  // namespace stillpoint::math
