// SPDX-License-Identifier: Apache-2.0
// The axis this firmware is delivered for, until parameters say otherwise: a linear axis of 1,000,000 counts a unit.
// Used by the target's main and by the test image, so that both drive the same axis.
#pragma once

#include <stddef.h>

#include "shaper/axis/axis_config.hpp"

namespace stillpoint::firmware {

// 10 unit/s, 1000 unit/s^2, 1e6 unit/s^3; the reference move (Li 2017: 1.2, 20, 600) is far inside. A quick stop brakes
// with 100 unit/s^2: 0.1 s from full speed.
inline constexpr AxisConfig kDefaultAxis{0.001, {1e7, 1e9, 1e9, 1e12}, 1e8, 1e11};

// LineSamples a shaper. A ZVD of 0.5 Hz, the lowest frequency promised, takes 2012; times 16 bytes: 32 KB.
inline constexpr size_t kLineCapacity = 2048;

}  // namespace stillpoint::firmware
