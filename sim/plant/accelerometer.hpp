// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/plant/noise.hpp"

namespace stillpoint::sim {

struct AccelerometerConfig {
  double resolution = 1e-3;  // unit/s^2 a raw step, above 0
  double range = 1e6;        // unit/s^2, saturates at plus and minus this
  double noise = 0.0;        // unit/s^2, standard deviation, before rounding
  uint64_t seed = 2;
};

// The accelerometer at the tip: raw steps of its resolution.
class Accelerometer {
 public:
  // Throws std::invalid_argument for a resolution or range not above zero, or noise that is negative; none may be
  // infinite.
  explicit Accelerometer(const AccelerometerConfig& config);

  int32_t read(double acceleration);

 private:
  AccelerometerConfig config_;
  Noise noise_;
};

}  // namespace stillpoint::sim
