// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillpoint::sim {

// Gaussian noise from a seed: the same numbers with every standard library, which std::normal_distribution does not
// promise. splitmix64 and the polar method of Marsaglia.
class Noise {
 public:
  // standard_deviation 0: silence.
  Noise(double standard_deviation, uint64_t seed) : standard_deviation_(standard_deviation), state_(seed) {}

  double next();

 private:
  double uniform();  // (-1, 1)

  double standard_deviation_;
  uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace stillpoint::sim
