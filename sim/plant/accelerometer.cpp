// SPDX-License-Identifier: Apache-2.0
#include "sim/plant/accelerometer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stillpoint::sim {

Accelerometer::Accelerometer(const AccelerometerConfig& config) : config_(config), noise_(config.noise, config.seed) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!positive(config.resolution)) throw std::invalid_argument("accelerometer: resolution not above zero");
  if (!positive(config.range)) throw std::invalid_argument("accelerometer: range not above zero");
  if (!std::isfinite(config.noise) || config.noise < 0.0) {
    throw std::invalid_argument("accelerometer: noise negative or not finite");
  }
}

int32_t Accelerometer::read(double acceleration) {
  const double seen = std::clamp(acceleration + noise_.next(), -config_.range, config_.range);
  const double raw = std::clamp(seen / config_.resolution, -2147483647.0, 2147483647.0);
  return static_cast<int32_t>(std::lround(raw));
}

}  // namespace stillpoint::sim
