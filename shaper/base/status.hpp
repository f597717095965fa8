// SPDX-License-Identifier: Apache-2.0
// How the module refuses: what is wrong, with which quantity, which value it had, which value would be accepted.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace stillpoint {

enum class Error : uint8_t {
  kNone,
  kNotFinite,      // NaN or infinity
  kNotPositive,    // must be above zero
  kBelowMinimum,   // `accepted` is the smallest value accepted
  kAboveMaximum,   // `accepted` is the largest value accepted
  kBusy,           // the axis moves, or an earlier request has not taken effect yet
  kLineTooShort,   // the delay line cannot hold the shaper; `accepted` is the lowest frequency (or length) it can
  kTooManyStages,  // the cascade has no room for another stage; `accepted` is the number it has
  kLimitExceeded,  // the shaped move would break the limit named; `accepted` is the least duration that would not
  kNotAvailable,   // this build or state cannot do it
};

enum class Quantity : uint8_t {
  kNone,
  kVelocity,
  kAcceleration,
  kDeceleration,
  kJerk,
  kTick,
  kDistance,
  kPosition,
  kDuration,
  kFrequency,
  kDampingRatio,
  kTolerance,
  kStages,
  kDelay,
  kKind,
  kSpacing,
  kImpulses,
  kImpulseTime,
  kImpulseAmplitude,
  kImpulseSum,
  kTaps,
  kMotorSpeed,
  kGearRatio,
  kPitch,
  kEncoder,
  kMotorConstant,
  kCurrent,
  kEfficiency,
  kFriction,
  kMass,
  kBandwidth,
  kElectrical,
  kFollowingError,
  kDecelerationJerk,
  kTable,
  kSamples,
  kChannels,
  kPreTrigger,
  kDecimation,
  kAmplitude,
  kTravel,
};

// The answer of everything that can refuse. A refusal leaves the state before it in force.
struct [[nodiscard]] Status {
  Error error = Error::kNone;
  Quantity quantity = Quantity::kNone;
  double value = 0.0;     // the value refused, in the unit it was given in
  double accepted = 0.0;  // the nearest value that would have been accepted, same unit; 0 where there is none

  constexpr Status() = default;
  constexpr Status(Error why, Quantity what, double refused, double nearest)
      : error(why), quantity(what), value(refused), accepted(nearest) {}
  // Out of line: it is copied and assigned in two hundred places.
  [[gnu::noinline]] constexpr Status(const Status& other)
      : error(other.error), quantity(other.quantity), value(other.value), accepted(other.accepted) {}
  [[gnu::noinline]] constexpr Status& operator=(const Status& other) {
    error = other.error;
    quantity = other.quantity;
    value = other.value;
    accepted = other.accepted;
    return *this;
  }

  constexpr bool ok() const { return error == Error::kNone; }
};

// Nothing refused. It is a Status wherever one is wanted, made out of line.
struct Accepted {
  [[gnu::noinline]] constexpr operator Status() const { return Status{}; }  // NOLINT(google-explicit-constructor)
};

constexpr Accepted kOk{};

constexpr Status refuse(Error error, Quantity quantity, double value, double accepted = 0.0) {
  return Status{error, quantity, value, accepted};
}

// What has no value, such as a state that cannot do it.
Status refuse(Error error, Quantity quantity = Quantity::kNone);

// Refuse, naming the quantity, what is not finite; what is not above zero either; what is not in [low, high] either.
Status check_finite(Quantity quantity, double value);
Status check_positive(Quantity quantity, double value);
Status check_range(Quantity quantity, double value, double low, double high);

// The same of a whole number.
Status check_count(Quantity quantity, size_t value, size_t low, size_t high);

// Words for people, e.g. "above the maximum", "frequency". Not on the tick path.
const char* text(Error error);
const char* text(Quantity quantity);

}  // namespace stillpoint
