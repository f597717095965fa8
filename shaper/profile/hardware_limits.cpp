// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/hardware_limits.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr double kSecondsAMinute = 60.0;
constexpr double kDecoding = 4.0;

double or_one(double value) { return value == 0.0 ? 1.0 : value; }

// What is 0 has an unknown in it, and what is infinite the reciprocal of one.
[[gnu::noinline]] void add_known(LimitedBy& limit, HardwareLimit by, double value) {
  if (value > 0.0 && value < math::kInfinity) limit.parts[limit.count++] = {by, value};
}

void add_velocities(const Hardware& hardware, LimitedBy& velocity) {
  const double travel = hardware.pitch_m / or_one(hardware.gear_ratio);  // metres a turn of the motor
  const double travel_a_pulse = hardware.pulses_per_rev > 0.0 ? travel / hardware.pulses_per_rev : 0.0;
  const double pulses = hardware.counter_max_hz / (kDecoding * or_one(hardware.interpolation));
  add_known(velocity, HardwareLimit::kMotor, hardware.motor_rpm / kSecondsAMinute * travel);
  add_known(velocity, HardwareLimit::kEncoder, hardware.encoder_max_hz * travel_a_pulse);
  add_known(velocity, HardwareLimit::kInterpolator, hardware.interpolator_max_hz * travel_a_pulse);
  add_known(velocity, HardwareLimit::kCounter, pulses * travel_a_pulse);
}

// N, before friction; not finite or 0 if not known.
double force_of(const Hardware& hardware) {
  if (hardware.force_constant > 0.0) return hardware.force_constant * hardware.max_current_a;
  const double torque = hardware.torque_constant * hardware.max_current_a * or_one(hardware.gear_ratio) *
                        or_one(hardware.gear_efficiency);
  return 2.0 * math::kPi * torque * or_one(hardware.screw_efficiency) / hardware.pitch_m;
}

// The following error is v / Kv + a / Ka: what one of them certainly leaves of the bound, or else half of it, is the
// other's.
void add_following_error(const Hardware& hardware, HardwareLimits& limits) {
  const double bound = hardware.max_following_error_m;
  const double constant[2] = {hardware.velocity_error_constant, hardware.acceleration_error_constant};
  LimitedBy* const limit[2] = {&limits.velocity, &limits.acceleration};
  double left[2];  // to the other
  for (int i = 0; i < 2; ++i) {
    const double error = constant[i] > 0.0 ? limit[i]->binding().value / constant[i] : 0.0;
    left[i] = bound - (error < 0.5 * bound ? error : 0.5 * bound);
  }
  for (int i = 0; i < 2; ++i) add_known(*limit[i], HardwareLimit::kFollowingError, constant[i] * left[1 - i]);
}

void add_jerks(const Hardware& hardware, double acceleration, LimitedBy& jerk) {
  // The current climbs towards U/R with L/R; it is all there once it has reached i.
  const double drop = hardware.max_current_a * hardware.resistance_ohm;
  const double share = hardware.supply_voltage > drop ? drop / hardware.supply_voltage : 0.0;
  HardwareLimit by = HardwareLimit::kElectricalTime;
  double climb = hardware.electrical_time_s;
  if (share > 0.0) {
    by = HardwareLimit::kSupplyVoltage;
    climb *= -math::log(1.0 - share);
  }
  const struct {
    HardwareLimit by;
    double seconds;
  } times[] = {{HardwareLimit::kCurrentBandwidth, 1.0 / (2.0 * math::kPi * hardware.current_bandwidth_hz)},
               {by, climb},
               {HardwareLimit::kControlRate, 2.0 / hardware.control_rate_hz},
               {HardwareLimit::kOutputBandwidth, 1.0 / (2.0 * math::kPi * hardware.output_bandwidth_hz)}};
  for (const auto& time : times) add_known(jerk, time.by, acceleration / time.seconds);
}

constexpr size_t kRows = 24;

constexpr double Hardware::*kMembers[kRows] = {&Hardware::motor_rpm,
                                               &Hardware::gear_ratio,
                                               &Hardware::pitch_m,
                                               &Hardware::pulses_per_rev,
                                               &Hardware::encoder_max_hz,
                                               &Hardware::interpolation,
                                               &Hardware::interpolator_max_hz,
                                               &Hardware::counter_max_hz,
                                               &Hardware::torque_constant,
                                               &Hardware::force_constant,
                                               &Hardware::max_current_a,
                                               &Hardware::gear_efficiency,
                                               &Hardware::screw_efficiency,
                                               &Hardware::friction_force_n,
                                               &Hardware::mass_kg,
                                               &Hardware::current_bandwidth_hz,
                                               &Hardware::electrical_time_s,
                                               &Hardware::supply_voltage,
                                               &Hardware::resistance_ohm,
                                               &Hardware::control_rate_hz,
                                               &Hardware::output_bandwidth_hz,
                                               &Hardware::velocity_error_constant,
                                               &Hardware::acceleration_error_constant,
                                               &Hardware::max_following_error_m};

constexpr Quantity kQuantities[kRows] = {
    Quantity::kMotorSpeed,    Quantity::kGearRatio,      Quantity::kPitch,          Quantity::kEncoder,
    Quantity::kEncoder,       Quantity::kEncoder,        Quantity::kEncoder,        Quantity::kEncoder,
    Quantity::kMotorConstant, Quantity::kMotorConstant,  Quantity::kCurrent,        Quantity::kEfficiency,
    Quantity::kEfficiency,    Quantity::kFriction,       Quantity::kMass,           Quantity::kBandwidth,
    Quantity::kElectrical,    Quantity::kElectrical,     Quantity::kElectrical,     Quantity::kBandwidth,
    Quantity::kBandwidth,     Quantity::kFollowingError, Quantity::kFollowingError, Quantity::kFollowingError};

}  // namespace

Status Hardware::validate() const {
  for (size_t i = 0; i < kRows; ++i) {
    const double value = this->*kMembers[i];
    const Status status = check_finite(kQuantities[i], value);
    if (!status.ok()) return status;
    if (value < 0.0) return refuse(Error::kBelowMinimum, kQuantities[i], value, 0.0);
    if (kQuantities[i] == Quantity::kEfficiency && value > 1.0)
      return refuse(Error::kAboveMaximum, Quantity::kEfficiency, value, 1.0);
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
    add_known(limits.acceleration, HardwareLimit::kForce, (force - hardware.friction_force_n) / hardware.mass_kg);
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
