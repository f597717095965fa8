// SPDX-License-Identifier: Apache-2.0
#include "sim/simulated_drive.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stillpoint::sim {

SimulatedDrive::SimulatedDrive(const SimulatedDriveConfig& config)
    : signal_per_unit_(config.counts_per_unit * static_cast<double>(kSignalPerCount)),
      reaction_(config.reaction),
      followed_(config.start),
      arm_(config.modes, config.tick_s),
      encoder_(config.encoder),
      accelerometer_(config.accelerometer) {
  if (!(reaction_ >= 0.0 && reaction_ < 1.0)) throw std::invalid_argument("drive: reaction outside [0, 1)");
}

hal::ServoFeedback SimulatedDrive::exchange(const hal::ServoCommand& command) {
  const Signal target = command.enabled ? command.setpoint : followed_;
  // The difference of two positions may take 65 bits; long double holds it, or rounds it by less than the arm can feel.
  const long double increment = static_cast<long double>(target) - static_cast<long double>(followed_);
  arm_.step(static_cast<double>(increment) / signal_per_unit_);
  followed_ = target;

  hal::ServoFeedback feedback{};
  feedback.position = encoder_.read(motor());
  feedback.acceleration = accelerometer_.read(arm_.acceleration());
  feedback.sequence = ++sequence_;
  feedback.valid = valid_;
  feedback.commit = commit_;
  return feedback;
}

Signal SimulatedDrive::motor() const {
  if (reaction_ == 0.0) return followed_;
  // Far from the ends of the range in any experiment; the clamp keeps the sum defined.
  constexpr long double kMost = 9.2233720368547e18L;
  const double given_way = reaction_ * arm_.deflection() * signal_per_unit_;
  const long double motor = static_cast<long double>(followed_) + static_cast<long double>(std::round(given_way));
  return static_cast<Signal>(std::clamp(motor, -kMost, kMost));
}

}  // namespace stillpoint::sim
