// SPDX-License-Identifier: Apache-2.0
#include "sim/refusal.hpp"

#include <algorithm>
#include <cstdio>

#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

bool in_counts(Quantity quantity) {
  switch (quantity) {
    case Quantity::kVelocity:
    case Quantity::kAcceleration:
    case Quantity::kDeceleration:
    case Quantity::kJerk:
    case Quantity::kDecelerationJerk:
    case Quantity::kDistance:
    case Quantity::kPosition:
    case Quantity::kAmplitude:
    case Quantity::kTravel: return true;
    default: return false;
  }
}

// Twelve digits: enough to type in again, without the last bits of a product.
std::string readable(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.12g", value);
  return buffer;
}

std::string at_least(double value) { return "at least " + readable(value); }

std::string underscored(std::string text) {
  std::replace(text.begin(), text.end(), ' ', '_');
  return text;
}

Refusal cannot(const std::string& what, double value, const std::string& why, const std::string& result) {
  return Refusal(Refusal::Cause::kCannot, what, shortest(value), why, result);
}

std::string accepted(const Status& status, double scale) {
  const std::string value = readable(status.accepted / scale);
  switch (status.error) {
    case Error::kNotFinite: return "a finite number is accepted";
    case Error::kNotPositive: return "a number above zero is accepted";
    case Error::kBelowMinimum: return at_least(status.accepted / scale) + " is accepted";
    case Error::kAboveMaximum: return "at most " + value + " is accepted";
    case Error::kTooManyStages: return "at most " + value + " stages are accepted";
    case Error::kLineTooShort: return "at most " + value + " ticks of delay line are accepted";
    case Error::kBusy: return "it is accepted when the axis is at rest";
    default: return "another " + std::string(text(status.quantity)) + " may be accepted";
  }
}

}  // namespace

Refusal::Refusal(Cause cause, const std::string& what, const std::string& value, const std::string& why,
                 const std::string& result)
    : std::runtime_error(what + ": " + value + ": " + why), cause_(cause), result_(result) {}

Refusal bad_argument(const std::string& what, const std::string& value, const std::string& why) {
  return Refusal(Refusal::Cause::kBadArgument, what, value, why, "bad_argument");
}

Refusal refusal_from(const Status& status, double counts_per_unit) {
  if (status.error == Error::kLimitExceeded) {
    const std::string limit = text(status.quantity);
    return cannot(
        "duration", status.value,
        "the shaped move would exceed its " + limit + " limit, " + at_least(status.accepted) + " s is accepted",
        underscored(limit + " limit"));
  }
  if (status.error == Error::kBelowMinimum && status.quantity == Quantity::kDuration) {
    return cannot("duration", status.value,
                  "shorter than the limits allow, " + at_least(status.accepted) + " s is accepted",
                  "duration_too_short");
  }
  const double scale = in_counts(status.quantity) ? counts_per_unit : 1.0;
  const std::string why = text(status.error) + (", " + accepted(status, scale));
  return bad_argument(text(status.quantity), shortest(status.value / scale), why);
}

void require(const Status& status, double counts_per_unit) {
  if (!status.ok()) throw refusal_from(status, counts_per_unit);
}

}  // namespace stillpoint::sim
