// SPDX-License-Identifier: Apache-2.0
// What an axis's hardware allows it (Profiles, "maximum velocity, acceleration, jerk, dynamic error"). Background.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/status.hpp"

namespace stillpoint {

// SI units; whatever is 0 is not known and limits nothing. Position is linear: a screw of `pitch_m` behind a gear that
// turns the motor `gear_ratio` times for one turn of the screw. A linear motor has a force constant, and a pitch only
// if its encoder is counted by it.
struct Hardware {
  double motor_rpm;            // of the motor, at the most
  double gear_ratio;           // 0: 1
  double pitch_m;              // a turn of the screw
  double pulses_per_rev;       // of the encoder's head (sine periods), a turn of the motor
  double encoder_max_hz;       // of the head, -3 dB
  double interpolation;        // factor of the interpolator behind the head; 0: 1
  double interpolator_max_hz;  // at its input
  double counter_max_hz;       // clock of the counter; decodes x4, so it takes a quarter of it in pulses
  double torque_constant;      // N m/A
  double force_constant;       // N/A, of a linear motor; instead of the torque constant
  double max_current_a;
  double gear_efficiency;   // 0: 1
  double screw_efficiency;  // 0: 1
  double friction_force_n;  // along the way
  double mass_kg;
  double current_bandwidth_hz;         // of the current loop, -3 dB
  double electrical_time_s;            // L/R of the motor
  double supply_voltage;               // V, and
  double resistance_ohm;               //   the motor's
  double control_rate_hz;              // of the control interrupt
  double output_bandwidth_hz;          // of the output stage
  double velocity_error_constant;      // 1/s: following error = velocity / this
  double acceleration_error_constant;  // 1/s^2
  double max_following_error_m;

  // Refuses, naming the quantity, the first that is not finite or below zero, an efficiency above 1, both a torque and
  // a force constant.
  Status validate() const;
};

enum class HardwareLimit : uint8_t {
  kNone,
  kMotor,
  kEncoder,
  kInterpolator,
  kCounter,
  kForce,
  kFollowingError,
  kCurrentBandwidth,
  kElectricalTime,
  kSupplyVoltage,
  kControlRate,
  kOutputBandwidth,
};
const char* text(HardwareLimit limit);

// One limit as several parts of the hardware would have it. The least binds.
struct LimitedBy {
  static constexpr size_t kMost = 5;
  struct Part {
    HardwareLimit by;
    double value;
  };
  size_t count;
  Part parts[kMost];

  // kNone and infinity where nothing is known.
  Part binding() const;
};

struct HardwareLimits {
  LimitedBy velocity;      // m/s
  LimitedBy acceleration;  // m/s^2
  // m/s^3, advisory: the time in which the force can be brought from nothing to all of it, for each part that takes
  // time: current loop 1 / (2 pi bandwidth), electrical time constant L/R (shortened by what voltage there is above
  // i R), two control interrupts, output stage 1 / (2 pi bandwidth); acceleration over that time.
  LimitedBy jerk;
};

// F = 2 pi tau eta_screw / pitch, tau = Kt i n eta_gear (or F = Kf i), minus friction, over the mass. The velocity and
// acceleration that bind keep the following error v / Kv + a / Ka within its bound together. Refuses what validate()
// refuses; and kAboveMaximum friction, with the motor's force, where nothing is left to accelerate with.
Status hardware_limits(const Hardware& hardware, HardwareLimits& out);

}  // namespace stillpoint
