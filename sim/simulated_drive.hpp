// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hal/servo_port.hpp"
#include "shaper/base/signal.hpp"
#include "sim/plant/accelerometer.hpp"
#include "sim/plant/arm.hpp"
#include "sim/plant/encoder.hpp"

namespace stillpoint::sim {

struct SimulatedDriveConfig {
  ArmModes modes;
  double tick_s = 1e-3;
  double counts_per_unit = 1e6;
  Signal start = 0;  // where the motor stands before it is enabled
  EncoderConfig encoder = {1, 0.0, 1};
  AccelerometerConfig accelerometer = {};
  // What an arm does to its motor: the part of the tip's deflection that the motor gives way by, in [0, 1). 0: none.
  //
  // The servo as a spring of stiffness K, the arm as one of stiffness c behind it: of a deflection of the tip from the
  // setpoint the motor has c / (K + c). `modes` are those of the arm on this motor, as they would be measured; they do
  // not change with it. No more than that: a real servo is stiffer at low frequencies (integral action) and softer
  // above its bandwidth, where the motor's inertia holds it; here it is the same at all. The modes share one part, as
  // if all pulled at the same place.
  double reaction = 0.0;
};

// A servo drive whose motor follows the setpoint exactly, linearly over a tick, but for what the arm behind it moves it
// by. A motor that is not enabled is held where it was.
class SimulatedDrive final : public hal::ServoPort {
 public:
  // Throws std::invalid_argument as Arm, Encoder and Accelerometer do, and for a reaction outside [0, 1).
  explicit SimulatedDrive(const SimulatedDriveConfig& config);

  hal::ServoFeedback exchange(const hal::ServoCommand& command) override;
  void disable() override {}

  // What the next feedback says of itself, until changed: to stage a bad encoder, or a tick at which results of the
  // background take effect. Both true to begin with.
  void set_valid(bool valid) { valid_ = valid; }
  void set_commit(bool commit) { commit_ = commit; }
  // As if `ticks` frames had been lost.
  void skip_sequence(uint16_t ticks) { sequence_ = static_cast<uint16_t>(sequence_ + ticks); }

  // The truth, which no feedback shows. Position and its derivatives in units.
  Signal motor() const;
  double motor_position() const { return position_of(motor()); }
  double tip_position() const { return position_of(followed_) + arm_.deflection(); }
  double tip_velocity() const { return arm_.velocity(); }
  double tip_acceleration() const { return arm_.acceleration(); }
  const Arm& arm() const { return arm_; }

 private:
  double position_of(Signal signal) const { return static_cast<double>(signal) / signal_per_unit_; }

  double signal_per_unit_;
  double reaction_;
  Signal followed_;  // the motor, were it not for the arm
  Arm arm_;
  Encoder encoder_;
  Accelerometer accelerometer_;
  uint16_t sequence_ = 0;
  bool valid_ = true;
  bool commit_ = true;
};

}  // namespace stillpoint::sim
