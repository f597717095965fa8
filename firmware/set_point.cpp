// SPDX-License-Identifier: Apache-2.0
#include "firmware/set_point.hpp"

#include "firmware/register_units.hpp"

namespace stillpoint::firmware {
namespace {

constexpr int32_t kTrapezoidType = 0;
constexpr int32_t kSin2Type = 1;
constexpr double kMsPerSecond = 1000.0;

ProfileKind kind_of(int32_t type) {
  switch (type) {
    case kTrapezoidType: return ProfileKind::kTrapezoid;
    case kSin2Type: return ProfileKind::kSin2;
    default: return ProfileKind::kSCurve;
  }
}

[[gnu::noinline]] Register culprit_of(const Status& status) {
  if (status.error == Error::kLimitExceeded) return Register::kMoveDurationMs;
  switch (status.quantity) {
    case Quantity::kVelocity: return Register::kProfileVelocity;
    case Quantity::kAcceleration: return Register::kProfileAcceleration;
    case Quantity::kDeceleration: return Register::kProfileDeceleration;
    case Quantity::kJerk:
    case Quantity::kDecelerationJerk: return Register::kProfileJerk;
    case Quantity::kDistance:
    case Quantity::kPosition: return Register::kTargetPosition;
    case Quantity::kDuration: return Register::kMoveDurationMs;
    case Quantity::kKind: return Register::kProfileType;
    default: return Register::kControlword;
  }
}

uint32_t accepted_in(Register culprit, const Status& status) {
  switch (culprit) {
    case Register::kTargetPosition: return signed_register(status.accepted);
    case Register::kProfileJerk: return register_floor(status.accepted / kJerkUnit);
    case Register::kMoveDurationMs:
      return status.error == Error::kAboveMaximum ? register_floor(status.accepted * kMsPerSecond)
                                                  : register_ceiling(status.accepted * kMsPerSecond);
    default: return register_floor(status.accepted);
  }
}

}  // namespace

AxisLimits profile_limits(const Parameters& parameters) {
  AxisLimits limits{};
  limits.velocity = parameters.get(Register::kProfileVelocity);
  limits.acceleration = parameters.get(Register::kProfileAcceleration);
  limits.deceleration = parameters.get(Register::kProfileDeceleration);
  limits.jerk = parameters.get(Register::kProfileJerk) * kJerkUnit;
  return limits;
}

Status make_move(const Parameters& parameters, bool relative, Signal from, Move& out) {
  int64_t target = parameters.get_signed(Register::kTargetPosition);
  if (relative) target += counts_from_signal(from);
  if (target > kMaxPositionCounts || target < kMinPositionCounts) {
    const bool above = target > kMaxPositionCounts;
    return refuse(above ? Error::kAboveMaximum : Error::kBelowMinimum, Quantity::kPosition, static_cast<double>(target),
                  above ? kMaxPositionCounts : kMinPositionCounts);
  }
  out.target_counts = static_cast<int32_t>(target);
  out.kind = kind_of(parameters.get_signed(Register::kProfileType));
  out.limits = profile_limits(parameters);
  out.duration_s = parameters.get(Register::kMoveDurationMs) / kMsPerSecond;
  out.zero_delay = parameters.get(Register::kZeroDelay) != 0;
  return kOk;
}

void note_move_refusal(const Status& status, Parameters& parameters) {
  const Register culprit = culprit_of(status);
  parameters.note_refusal(reason_of(status.error, status.quantity), address_of(culprit), accepted_in(culprit, status));
}

// A velocity is signed, and the largest accepted has its sign.
void note_velocity_refusal(const Status& status, Parameters& parameters) {
  if (status.quantity != Quantity::kVelocity) return note_move_refusal(status, parameters);
  const int32_t accepted = static_cast<int32_t>(signed_register(status.accepted));
  parameters.note_refusal(reason_of(status.error, status.quantity), address_of(Register::kTargetVelocity),
                          static_cast<uint32_t>(status.value < 0.0 ? -accepted : accepted));
}

void note_move_report(const MoveReport& report, Parameters& parameters) {
  parameters.set(Register::kMoveProfileTicks, report.profile_ticks);
  parameters.set(Register::kMoveTotalTicks, report.total_ticks);
  parameters.set(Register::kMoveZeroDelayMet, report.zero_delay_met ? 1 : 0);
}

}  // namespace stillpoint::firmware
