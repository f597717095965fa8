// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/hardware_limits.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr double kSecondsAMinute = 60.0;
constexpr double kDecoding = 4.0;

double or_one(double value) { return value == 0.0 ? 1.0 : value; }

void add(LimitedBy& limit, HardwareLimit by, double value) { limit.parts[limit.count++] = {by, value}; }

// Metres a turn of the motor; 0 if not known.
double travel_a_turn(const Hardware& hardware) { return hardware.pitch_m / or_one(hardware.gear_ratio); }

void add_velocities(const Hardware& hardware, LimitedBy& velocity) {
  const double travel = travel_a_turn(hardware);
  if (travel > 0.0 && hardware.motor_rpm > 0.0)
    add(velocity, HardwareLimit::kMotor, hardware.motor_rpm / kSecondsAMinute * travel);
  if (travel > 0.0 && hardware.pulses_per_rev > 0.0) {
    const double travel_a_pulse = travel / hardware.pulses_per_rev;
    if (hardware.encoder_max_hz > 0.0) add(velocity, HardwareLimit::kEncoder, hardware.encoder_max_hz * travel_a_pulse);
    if (hardware.interpolator_max_hz > 0.0)
      add(velocity, HardwareLimit::kInterpolator, hardware.interpolator_max_hz * travel_a_pulse);
    if (hardware.counter_max_hz > 0.0) {
      const double pulses = hardware.counter_max_hz / (kDecoding * or_one(hardware.interpolation));
      add(velocity, HardwareLimit::kCounter, pulses * travel_a_pulse);
    }
  }
}

// N, before friction; 0 if not known.
double force_of(const Hardware& hardware) {
  if (hardware.force_constant > 0.0) return hardware.force_constant * hardware.max_current_a;
  if (hardware.pitch_m == 0.0) return 0.0;
  const double torque = hardware.torque_constant * hardware.max_current_a * or_one(hardware.gear_ratio) *
                        or_one(hardware.gear_efficiency);
  return 2.0 * math::kPi * torque * or_one(hardware.screw_efficiency) / hardware.pitch_m;
}

// The following error is v / Kv + a / Ka: what one of them certainly leaves of the bound, or else half of it, is the
// other's.
void add_following_error(const Hardware& hardware, HardwareLimits& limits) {
  const double bound = hardware.max_following_error_m;
  const double kv = hardware.velocity_error_constant;
  const double ka = hardware.acceleration_error_constant;
  if (!(bound > 0.0)) return;
  const double half = 0.5 * bound;
  const double of_velocity = kv > 0.0 ? limits.velocity.binding().value / kv : 0.0;
  const double of_acceleration = ka > 0.0 ? limits.acceleration.binding().value / ka : 0.0;
  if (kv > 0.0)
    add(limits.velocity, HardwareLimit::kFollowingError,
        kv * (bound - (of_acceleration < half ? of_acceleration : half)));
  if (ka > 0.0)
    add(limits.acceleration, HardwareLimit::kFollowingError, ka * (bound - (of_velocity < half ? of_velocity : half)));
}

void add_jerks(const Hardware& hardware, double acceleration, LimitedBy& jerk) {
  const auto add_time = [&](HardwareLimit by, double seconds) { add(jerk, by, acceleration / seconds); };
  if (hardware.current_bandwidth_hz > 0.0)
    add_time(HardwareLimit::kCurrentBandwidth, 1.0 / (2.0 * math::kPi * hardware.current_bandwidth_hz));
  if (hardware.electrical_time_s > 0.0) {
    const double drop = hardware.max_current_a * hardware.resistance_ohm;
    const bool knows_voltage = hardware.supply_voltage > 0.0 && drop > 0.0;
    if (knows_voltage && hardware.supply_voltage > drop) {
      // The current climbs towards U/R with L/R; it is all there once it has reached i.
      const double share = drop / hardware.supply_voltage;
      add_time(HardwareLimit::kSupplyVoltage, -hardware.electrical_time_s * math::log(1.0 - share));
    } else {
      add_time(HardwareLimit::kElectricalTime, hardware.electrical_time_s);
    }
  }
  if (hardware.control_rate_hz > 0.0) add_time(HardwareLimit::kControlRate, 2.0 / hardware.control_rate_hz);
  if (hardware.output_bandwidth_hz > 0.0)
    add_time(HardwareLimit::kOutputBandwidth, 1.0 / (2.0 * math::kPi * hardware.output_bandwidth_hz));
}

}  // namespace

Status Hardware::validate() const {
  struct Row {
    Quantity quantity;
    double value;
  };
  const Row rows[] = {{Quantity::kMotorSpeed, motor_rpm},
                      {Quantity::kGearRatio, gear_ratio},
                      {Quantity::kPitch, pitch_m},
                      {Quantity::kEncoder, pulses_per_rev},
                      {Quantity::kEncoder, encoder_max_hz},
                      {Quantity::kEncoder, interpolation},
                      {Quantity::kEncoder, interpolator_max_hz},
                      {Quantity::kEncoder, counter_max_hz},
                      {Quantity::kMotorConstant, torque_constant},
                      {Quantity::kMotorConstant, force_constant},
                      {Quantity::kCurrent, max_current_a},
                      {Quantity::kEfficiency, gear_efficiency},
                      {Quantity::kEfficiency, screw_efficiency},
                      {Quantity::kFriction, friction_force_n},
                      {Quantity::kMass, mass_kg},
                      {Quantity::kBandwidth, current_bandwidth_hz},
                      {Quantity::kElectrical, electrical_time_s},
                      {Quantity::kElectrical, supply_voltage},
                      {Quantity::kElectrical, resistance_ohm},
                      {Quantity::kBandwidth, control_rate_hz},
                      {Quantity::kBandwidth, output_bandwidth_hz},
                      {Quantity::kFollowingError, velocity_error_constant},
                      {Quantity::kFollowingError, acceleration_error_constant},
                      {Quantity::kFollowingError, max_following_error_m}};
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
    if (!math::is_finite(rows[i].value)) return refuse(Error::kNotFinite, rows[i].quantity, rows[i].value);
    if (rows[i].value < 0.0) return refuse(Error::kBelowMinimum, rows[i].quantity, rows[i].value, 0.0);
    if (rows[i].quantity == Quantity::kEfficiency && rows[i].value > 1.0)
      return refuse(Error::kAboveMaximum, Quantity::kEfficiency, rows[i].value, 1.0);
  }
  if (torque_constant > 0.0 && force_constant > 0.0)
    return refuse(Error::kAboveMaximum, Quantity::kMotorConstant, force_constant, 0.0);
  return kOk;
}

LimitedBy::Part LimitedBy::binding() const {
  Part least{HardwareLimit::kNone, math::kInfinity};
  for (size_t i = 0; i < count; ++i) {
    if (parts[i].value < least.value) least = parts[i];
  }
  return least;
}

Status hardware_limits(const Hardware& hardware, HardwareLimits& out) {
  const Status status = hardware.validate();
  if (!status.ok()) return status;
  HardwareLimits limits{};
  add_velocities(hardware, limits.velocity);
  const double force = force_of(hardware);
  if (force > 0.0 && hardware.mass_kg > 0.0) {
    if (!(hardware.friction_force_n < force))
      return refuse(Error::kAboveMaximum, Quantity::kFriction, hardware.friction_force_n, force);
    add(limits.acceleration, HardwareLimit::kForce, (force - hardware.friction_force_n) / hardware.mass_kg);
  }
  add_following_error(hardware, limits);
  if (limits.acceleration.count > 0) add_jerks(hardware, limits.acceleration.binding().value, limits.jerk);
  out = limits;
  return kOk;
}

const char* text(HardwareLimit limit) {
  switch (limit) {
    case HardwareLimit::kNone: return "nothing";
    case HardwareLimit::kMotor: return "motor";
    case HardwareLimit::kEncoder: return "encoder";
    case HardwareLimit::kInterpolator: return "interpolator";
    case HardwareLimit::kCounter: return "counter";
    case HardwareLimit::kForce: return "force";
    case HardwareLimit::kFollowingError: return "following_error";
    case HardwareLimit::kCurrentBandwidth: return "current_bandwidth";
    case HardwareLimit::kElectricalTime: return "electrical_time";
    case HardwareLimit::kSupplyVoltage: return "supply_voltage";
    case HardwareLimit::kControlRate: return "control_rate";
    case HardwareLimit::kOutputBandwidth: return "output_bandwidth";
  }
  return "unknown";
}

}  // namespace stillpoint
