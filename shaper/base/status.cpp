// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/status.hpp"

#include "shaper/base/math_bits.hpp"

namespace stillpoint {

[[gnu::noinline]] Status refuse(Error error, Quantity quantity) { return refuse(error, quantity, 0.0); }

Status check_finite(Quantity quantity, double value) {
  return math::is_finite(value) ? kOk : refuse(Error::kNotFinite, quantity, value);
}

Status check_positive(Quantity quantity, double value) {
  if (math::is_finite(value) && !(value > 0.0)) return refuse(Error::kNotPositive, quantity, value);
  return check_finite(quantity, value);
}

Status check_range(Quantity quantity, double value, double low, double high) {
  if (!math::is_finite(value)) return refuse(Error::kNotFinite, quantity, value);
  if (value < low) return refuse(Error::kBelowMinimum, quantity, value, low);
  if (value > high) return refuse(Error::kAboveMaximum, quantity, value, high);
  return kOk;
}

Status check_count(Quantity quantity, size_t value, size_t low, size_t high) {
  return check_range(quantity, static_cast<double>(value), static_cast<double>(low), static_cast<double>(high));
}

const char* text(Error error) {
  switch (error) {
    case Error::kNone: return "no error";
    case Error::kNotFinite: return "not a finite number";
    case Error::kNotPositive: return "must be above zero";
    case Error::kBelowMinimum: return "below the minimum";
    case Error::kAboveMaximum: return "above the maximum";
    case Error::kBusy: return "the axis is moving or a request is pending";
    case Error::kLineTooShort: return "the delay line is too short";
    case Error::kTooManyStages: return "the cascade has no room for another stage";
    case Error::kLimitExceeded: return "the shaped move would exceed this limit";
    case Error::kNotAvailable: return "not available";
  }
  return "unknown error";
}

const char* text(Quantity quantity) {
  switch (quantity) {
    case Quantity::kNone: return "request";
    case Quantity::kVelocity: return "velocity";
    case Quantity::kAcceleration: return "acceleration";
    case Quantity::kDeceleration: return "deceleration";
    case Quantity::kJerk: return "jerk";
    case Quantity::kTick: return "tick";
    case Quantity::kDistance: return "distance";
    case Quantity::kPosition: return "position";
    case Quantity::kDuration: return "duration";
    case Quantity::kFrequency: return "frequency";
    case Quantity::kDampingRatio: return "damping ratio";
    case Quantity::kTolerance: return "tolerance";
    case Quantity::kStages: return "stages";
    case Quantity::kDelay: return "delay";
    case Quantity::kKind: return "kind";
    case Quantity::kSpacing: return "spacing";
    case Quantity::kImpulses: return "number of impulses";
    case Quantity::kImpulseTime: return "impulse time";
    case Quantity::kImpulseAmplitude: return "impulse amplitudes";
    case Quantity::kMotorSpeed: return "motor speed";
    case Quantity::kGearRatio: return "gear ratio";
    case Quantity::kPitch: return "pitch";
    case Quantity::kEncoder: return "encoder";
    case Quantity::kMotorConstant: return "motor constant";
    case Quantity::kCurrent: return "current";
    case Quantity::kEfficiency: return "efficiency";
    case Quantity::kFriction: return "friction force";
    case Quantity::kMass: return "mass";
    case Quantity::kBandwidth: return "bandwidth or rate";
    case Quantity::kElectrical: return "electrical constant";
    case Quantity::kFollowingError: return "following error";
    case Quantity::kDecelerationJerk: return "deceleration jerk";
    case Quantity::kTable: return "profile table";
    case Quantity::kSamples: return "samples";
    case Quantity::kChannels: return "channels";
    case Quantity::kPreTrigger: return "pre-trigger";
    case Quantity::kDecimation: return "decimation";
    case Quantity::kAmplitude: return "amplitude";
    case Quantity::kTravel: return "travel";
    case Quantity::kTaps: return "taps";
    case Quantity::kImpulseSum: return "sum of impulse amplitudes";
  }
  return "unknown quantity";
}

}  // namespace stillpoint
