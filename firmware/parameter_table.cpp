// SPDX-License-Identifier: Apache-2.0
#include "firmware/default_axis.hpp"
#include "firmware/parameters.hpp"

namespace stillpoint::firmware {
namespace {

using R = Register;
using T = Type;

constexpr uint32_t kU16Max = UINT16_MAX;
constexpr uint32_t kU32Max = UINT32_MAX;
constexpr uint32_t kI32Min = UINT32_C(1) << 31;
constexpr uint32_t kI32Max = INT32_MAX;
constexpr uint32_t kAny = 0;

// Of the delivered axis; Parameters::adopt puts those of the actual one over them.
constexpr auto kMaxVelocity = static_cast<uint32_t>(kDefaultAxis.maximum.velocity);
constexpr auto kMaxAcceleration = static_cast<uint32_t>(kDefaultAxis.maximum.acceleration);
constexpr auto kMaxJerk = static_cast<uint32_t>(kDefaultAxis.maximum.jerk / kJerkUnit);
constexpr auto kStopDeceleration = static_cast<uint32_t>(kDefaultAxis.quick_stop_deceleration);
constexpr auto kStopJerk = static_cast<uint32_t>(kDefaultAxis.quick_stop_jerk / kJerkUnit);

constexpr uint32_t one_of(uint32_t a) { return UINT32_C(1) << a; }
constexpr uint32_t one_of(uint32_t a, uint32_t b) { return one_of(a) | one_of(b); }
constexpr uint32_t one_of(uint32_t a, uint32_t b, uint32_t c) { return one_of(a, b) | one_of(c); }

constexpr Parameter shown(R name, T type, uint16_t object, uint32_t initial, const char* text, const char* unit = "") {
  return {name, type, Access::kRead, Lock::kOpen, Effect::kNone, kNoRegister, object, 0, 0, initial, kAny, text, unit};
}

constexpr Parameter value(R name, T type, uint16_t object, uint32_t minimum, uint32_t maximum, uint32_t initial,
                          const char* text, const char* unit, uint32_t allowed = kAny) {
  Parameter parameter = shown(name, type, object, initial, text, unit);
  parameter.access = Access::kReadWrite;
  parameter.minimum = minimum;
  parameter.maximum = maximum;
  parameter.allowed = allowed;
  return parameter;
}

constexpr Parameter command(R name, uint32_t maximum, uint32_t allowed, Effect effect, const char* text) {
  Parameter parameter = value(name, T::kU16, 0, 0, maximum, 0, text, "", allowed);
  parameter.access = Access::kWrite;
  parameter.effect = effect;
  return parameter;
}

constexpr Parameter with(Effect effect, Parameter parameter) {
  parameter.effect = effect;
  return parameter;
}

constexpr Parameter locked(Parameter parameter) {
  parameter.lock = Lock::kNeedsKey;
  return parameter;
}

// One of the axis's own limits.
constexpr Parameter limit(R name, uint16_t object, uint32_t initial, const char* text, const char* unit) {
  return with(Effect::kAxisLimits, locked(value(name, T::kU32, object, 1, kU32Max, initial, text, unit)));
}

constexpr Parameter soft_limit(R name, const char* text) {
  return with(Effect::kAxisLimits, locked(value(name, T::kI32, 0x607D, kI32Min, kI32Max, 0, text, "counts")));
}

// One of a move's.
constexpr Parameter profile(R name, uint16_t object, uint32_t initial, R ceiling, const char* text, const char* unit) {
  Parameter parameter = value(name, T::kU32, object, 1, kU32Max, initial, text, unit);
  parameter.ceiling = ceiling;
  return parameter;
}

constexpr Parameter under(R ceiling, Parameter parameter) {
  parameter.ceiling = ceiling;
  return parameter;
}

// The register at `offset` of a mode's block. The reserved ones read 0 and take 0, so that a client can write the
// block.
constexpr Parameter mode(uint32_t index, uint32_t offset) {
  const auto name = static_cast<R>(address_of(R::kFirstMode) + kModeStride * index + offset);
  switch (static_cast<ModeField>(offset)) {
    case ModeField::kFrequency: return value(name, T::kU32, 0, 0, 3000000, 0, "mode frequency", "1e-4 Hz");
    case ModeField::kDamping: return value(name, T::kU16, 0, 0, 30000, 0, "mode damping ratio", "1e-5");
    case ModeField::kTolerance: return value(name, T::kU16, 0, 0, 2000, 0, "mode tolerance", "0.01 %");
    case ModeField::kKind: return value(name, T::kU16, 0, 0, 13, 0, "mode shaper type", "");
    case ModeField::kSpacing:
      return value(name, T::kU16, 0, 0, 5000, 0, "mode spacing of MZV's impulses", "1e-4 periods");
    default: return value(name, T::kU16, 0, 0, 0, 0, "reserved", "");
  }
}

}  // namespace

// clang-format off
constexpr Parameter kParameters[kParameterCount] = {
    shown(R::kMapVersion, T::kU16, 0, kMapVersion, "map version"),
    shown(R::kProduct, T::kU16, 0, kProduct, "product"),
    shown(R::kFirmwareVersion, T::kU16, 0, kFirmwareVersion, "firmware version"),
    shown(R::kBuild, T::kU16, 0, 0, "build"),
    shown(R::kUptimeMs, T::kU32, 0, 0, "uptime", "ms"),
    shown(R::kWordOrderProbe, T::kU32, 0, kWordOrderProbe, "word-order probe"),
    shown(R::kSupportedModes, T::kU32, 0x6502, kSupportedModes, "supported modes", "bits"),
    shown(R::kErrorCode, T::kU16, 0x603F, 0, "error code"),
    shown(R::kWarnings, T::kU16, 0, 0, "warnings", "bits"),
    shown(R::kRefusalReason, T::kU16, 0, 0, "last refusal: reason"),
    shown(R::kRefusedRegister, T::kU16, 0, 0, "last refusal: register"),
    command(R::kCommandKey, kU16Max, kAny, Effect::kCommandKey, "command key"),
    shown(R::kCommandResult, T::kU16, 0, 0, "command result"),
    shown(R::kRefusalAccepted, T::kU32, 0, 0, "last refusal: value that would be accepted"),
    shown(R::kServoTicks, T::kU32, 0, 0, "servo ticks", "ticks"),
    shown(R::kServoMissing, T::kU32, 0, 0, "servo feedbacks missing", "ticks"),
    shown(R::kServoLinkLosses, T::kU32, 0, 0, "servo link losses"),
    locked(value(R::kUnitId, T::kU16, 0, 1, 247, 1, "unit id, from the next start on", "")),

    with(Effect::kControlword, value(R::kControlword, T::kU16, 0x6040, 0, kU16Max, 0, "controlword", "bits")),
    shown(R::kStatusword, T::kU16, 0x6041, 0, "statusword", "bits"),
    value(R::kMode, T::kI16, 0x6060, 1, 8, 1, "mode", "", one_of(1)),
    shown(R::kModeDisplay, T::kI16, 0x6061, 1, "mode display"),
    value(R::kTargetPosition, T::kI32, 0x607A, kI32Min, kI32Max, 0, "target position", "counts"),
    shown(R::kActualPosition, T::kI32, 0x6064, 0, "actual position", "counts"),
    shown(R::kDemandBeforeShaping, T::kI32, 0, 0, "demand before shaping", "counts"),
    shown(R::kDemandAfterShaping, T::kI32, 0x6062, 0, "demand after shaping", "counts"),
    shown(R::kFollowingError, T::kI32, 0x60F4, 0, "following error", "counts"),
    shown(R::kActualVelocity, T::kI32, 0x606C, 0, "actual velocity", "counts/s"),

    under(R::kMaximumJerk, limit(R::kQuickStopJerk, 0, kStopJerk, "quick-stop jerk", "1000 counts/s^3")),
    limit(R::kMaximumVelocity, 0x607F, kMaxVelocity, "maximum velocity", "counts/s"),
    limit(R::kMaximumAcceleration, 0x60C5, kMaxAcceleration, "maximum acceleration", "counts/s^2"),
    limit(R::kMaximumJerk, 0, kMaxJerk, "maximum jerk", "1000 counts/s^3"),
    profile(R::kProfileVelocity, 0x6081, 1200000, R::kMaximumVelocity, "profile velocity", "counts/s"),
    profile(R::kProfileAcceleration, 0x6083, 20000000, R::kMaximumAcceleration, "acceleration", "counts/s^2"),
    profile(R::kProfileDeceleration, 0x6084, 20000000, R::kMaximumAcceleration, "deceleration", "counts/s^2"),
    under(R::kMaximumAcceleration,
          limit(R::kQuickStopDeceleration, 0x6085, kStopDeceleration, "quick-stop deceleration", "counts/s^2")),
    profile(R::kProfileJerk, 0x60A4, 600000, R::kMaximumJerk, "jerk", "1000 counts/s^3"),
    value(R::kProfileType, T::kI16, 0x6086, 0, 3, 3, "profile type", "", one_of(0, 1, 3)),
    // Not watched yet: anything but off would promise what nobody keeps.
    locked(value(R::kFollowingErrorWindow, T::kU32, 0x6065, 0, 0, 0, "following-error window", "counts")),
    locked(value(R::kFollowingErrorTimeMs, T::kU16, 0x6066, 0, kU16Max, 10, "following-error time", "ms")),
    with(Effect::kPositionWindow,
         value(R::kPositionWindow, T::kU32, 0x6067, 0, kU32Max, 100, "position window", "counts")),
    value(R::kPositionTimeMs, T::kU16, 0x6068, 0, kU16Max, 20, "position window time", "ms"),
    // Low at or above high: none.
    soft_limit(R::kSoftLimitLow, "soft limit low"),
    soft_limit(R::kSoftLimitHigh, "soft limit high"),

    value(R::kModeCount, T::kU16, 0, 0, kMaxModes, 0, "modes staged", ""),
    with(Effect::kShaperSet, value(R::kShaperSet, T::kU16, 0, 0, kShaperSets - 1, 0, "shaper set", "")),
    mode(0, 0), mode(0, 2), mode(0, 3), mode(0, 4), mode(0, 5), mode(0, 6), mode(0, 7),
    mode(1, 0), mode(1, 2), mode(1, 3), mode(1, 4), mode(1, 5), mode(1, 6), mode(1, 7),
    mode(2, 0), mode(2, 2), mode(2, 3), mode(2, 4), mode(2, 5), mode(2, 6), mode(2, 7),
    mode(3, 0), mode(3, 2), mode(3, 3), mode(3, 4), mode(3, 5), mode(3, 6), mode(3, 7),
    command(R::kApplyShaper, 3, one_of(1, 2, 3), Effect::kApplyShaper, "shaper: 1 apply at rest, 2 blended, 3 discard"),
    shown(R::kShaperState, T::kU16, 0, 0, "shaper state"),
    shown(R::kShaperRefusal, T::kU16, 0, 0, "shaper refusal reason"),
    shown(R::kActiveDelayUs, T::kU32, 0, 0, "active shaper's delay", "us"),
    // Of the active shaper as it runs, all stages, at the modes that it was applied for; the worst of them, saturating.
    // How far a mode may be off is its tolerance's business, not this number's.
    shown(R::kPredictedResidual, T::kU16, 0, 0, "predicted worst residual at the modes", "0.01 %"),
    value(R::kZeroDelay, T::kU16, 0, 0, 1, 0, "zero delay", ""),
    value(R::kMoveDurationMs, T::kU32, 0, 0, kU32Max, 0, "move duration", "ms"),
    shown(R::kMoveProfileTicks, T::kU32, 0, 0, "last move: ticks of its profile", "ticks"),
    shown(R::kMoveTotalTicks, T::kU32, 0, 0, "last move: ticks until the shaped setpoint stands", "ticks"),
    shown(R::kMoveZeroDelayMet, T::kU16, 0, 0, "last move: shaped within the unshaped duration"),
};
// clang-format on

namespace {

constexpr bool addresses_rise_without_overlap() {
  for (size_t i = 1; i < kParameterCount; ++i) {
    if (address_of(kParameters[i].name) < address_of(kParameters[i - 1].name) + kParameters[i - 1].words())
      return false;
  }
  return true;
}

constexpr bool wide_values_are_even() {
  for (size_t i = 0; i < kParameterCount; ++i) {
    if (kParameters[i].words() == 2 && address_of(kParameters[i].name) % 2 != 0) return false;
  }
  return true;
}

static_assert(addresses_rise_without_overlap(), "find_parameter searches by halves; kParameterCount is their number");
static_assert(wide_values_are_even(), "a promise of the register map");

}  // namespace

size_t find_parameter(uint16_t address) {
  size_t low = 0;
  size_t high = kParameterCount;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    if (address_of(kParameters[middle].name) <= address) {
      low = middle;
    } else {
      high = middle;
    }
  }
  const Parameter& found = kParameters[low];
  const bool covered = address >= address_of(found.name) && address < address_of(found.name) + found.words();
  return covered ? low : kNoParameter;
}

}  // namespace stillpoint::firmware
