// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "shaper/base/signal.hpp"
#include "sim/plant/noise.hpp"

namespace stillpoint::sim {

struct EncoderConfig {
  int64_t resolution = kSignalPerCount;  // signal LSB a line, above 0; 1: passes the motor's position as it is
  double noise_counts = 0.0;             // standard deviation, before rounding to lines
  uint64_t seed = 1;
};

// The motor's encoder: the nearest multiple of its resolution, saturated to the range of positions.
class Encoder {
 public:
  // Throws std::invalid_argument for a resolution not above zero, or noise that is negative or not finite.
  explicit Encoder(const EncoderConfig& config);

  Signal read(Signal motor);

 private:
  int64_t resolution_;
  Noise noise_;
};

}  // namespace stillpoint::sim
