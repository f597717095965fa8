// SPDX-License-Identifier: Apache-2.0
#include "sim/simulated_drive.hpp"

namespace stillpoint::sim {

SimulatedDrive::SimulatedDrive(const SimulatedDriveConfig& config)
    : signal_per_unit_(config.counts_per_unit * static_cast<double>(kSignalPerCount)),
      motor_(config.start),
      arm_(config.modes, config.tick_s),
      encoder_(config.encoder),
      accelerometer_(config.accelerometer) {}

hal::ServoFeedback SimulatedDrive::exchange(const hal::ServoCommand& command) {
  const Signal target = command.enabled ? command.setpoint : motor_;
  // The difference of two positions may take 65 bits; long double holds it, or rounds it by less than the arm can feel.
  const long double increment = static_cast<long double>(target) - static_cast<long double>(motor_);
  arm_.step(static_cast<double>(increment) / signal_per_unit_);
  motor_ = target;

  hal::ServoFeedback feedback{};
  feedback.position = encoder_.read(motor_);
  feedback.acceleration = accelerometer_.read(arm_.acceleration());
  feedback.sequence = ++sequence_;
  feedback.valid = valid_;
  feedback.commit = commit_;
  return feedback;
}

}  // namespace stillpoint::sim
