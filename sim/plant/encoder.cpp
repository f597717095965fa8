// SPDX-License-Identifier: Apache-2.0
#include "sim/plant/encoder.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stillpoint::sim {
namespace {

constexpr Signal kLowest = signal_from_counts(kMinPositionCounts);
constexpr Signal kHighest = signal_from_counts(kMaxPositionCounts);

Signal saturating_add(Signal a, Signal b) {
  Signal sum = 0;
  if (__builtin_add_overflow(a, b, &sum)) return b < 0 ? kLowest : kHighest;
  return std::clamp(sum, kLowest, kHighest);
}

// The multiple of `step` at or below.
Signal floor_to(Signal value, int64_t step) {
  const int64_t remainder = value % step;
  return saturating_add(value, remainder < 0 ? -step - remainder : -remainder);
}

}  // namespace

Encoder::Encoder(const EncoderConfig& config)
    : resolution_(config.resolution), noise_(config.noise_counts, config.seed) {
  if (config.resolution <= 0) throw std::invalid_argument("encoder: resolution not above zero");
  if (!std::isfinite(config.noise_counts) || config.noise_counts < 0.0) {
    throw std::invalid_argument("encoder: noise negative or not finite");
  }
}

Signal Encoder::read(Signal motor) {
  const double noise = noise_.next();
  if (noise != 0.0) {
    // 2^30 counts of noise is beyond any encoder; the clamp keeps the conversion defined.
    const double counts = std::clamp(noise, -1073741824.0, 1073741824.0);
    motor = saturating_add(motor, static_cast<Signal>(std::llround(counts * static_cast<double>(kSignalPerCount))));
  }
  return floor_to(saturating_add(motor, resolution_ / 2), resolution_);
}

}  // namespace stillpoint::sim
