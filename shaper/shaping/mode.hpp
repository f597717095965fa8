// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/base/status.hpp"

namespace stillpoint {

// One vibration mode of the arm.
struct Mode {
  double frequency_hz;   // natural (undamped) frequency
  double damping_ratio;  // 0 up to, not including, 1

  // Finite, frequency above zero, damping in [0, 1). O(1), any context.
  Status validate() const;
};

}  // namespace stillpoint
