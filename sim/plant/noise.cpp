// SPDX-License-Identifier: Apache-2.0
#include "sim/plant/noise.hpp"

#include <cmath>

namespace stillpoint::sim {

double Noise::uniform() {
  state_ += UINT64_C(0x9E3779B97F4A7C15);
  uint64_t z = state_;
  z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
  z ^= z >> 31;
  constexpr double kScale = 1.0 / 4503599627370496.0;  // 2^-52
  return (static_cast<double>(z >> 11) + 0.5) * kScale - 1.0;
}

double Noise::next() {
  if (standard_deviation_ == 0.0) return 0.0;
  if (has_spare_) {
    has_spare_ = false;
    return standard_deviation_ * spare_;
  }
  double x = 0.0;
  double y = 0.0;
  double square = 0.0;
  do {
    x = uniform();
    y = uniform();
    square = x * x + y * y;
  } while (square >= 1.0 || square == 0.0);
  const double scale = std::sqrt(-2.0 * std::log(square) / square);
  spare_ = y * scale;
  has_spare_ = true;
  return standard_deviation_ * x * scale;
}

}  // namespace stillpoint::sim
