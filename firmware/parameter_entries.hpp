// SPDX-License-Identifier: Apache-2.0
// What the parameters are: a row each. How they lie in flash is parameter_table.cpp's, which alone includes this.
#pragma once

#include <stdint.h>

#include "firmware/default_axis.hpp"
#include "firmware/feedback_watch.hpp"
#include "firmware/line_settings.hpp"
#include "firmware/parameters.hpp"
#include "firmware/position_stream.hpp"
#include "shaper/identify/capture.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint::firmware::entries {

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

struct Entry : Parameter {
  ParameterText told;
};

constexpr Entry shown(R name, T type, uint16_t object, uint32_t initial, const char* text, const char* unit = "") {
  return {{name, type, Access::kRead, Lock::kOpen, Effect::kNone, kNoRegister, 0, 0, initial, kAny},
          {text, unit, object}};
}

constexpr Entry value(R name, T type, uint16_t object, uint32_t minimum, uint32_t maximum, uint32_t initial,
                      const char* text, const char* unit, uint32_t allowed = kAny) {
  Entry parameter = shown(name, type, object, initial, text, unit);
  parameter.access = Access::kReadWrite;
  parameter.minimum = minimum;
  parameter.maximum = maximum;
  parameter.allowed = allowed;
  return parameter;
}

constexpr Entry command(R name, uint32_t maximum, uint32_t allowed, Effect effect, const char* text) {
  Entry parameter = value(name, T::kU16, 0, 0, maximum, 0, text, "", allowed);
  parameter.access = Access::kWrite;
  parameter.effect = effect;
  return parameter;
}

constexpr Entry with(Effect effect, Entry parameter) {
  parameter.effect = effect;
  return parameter;
}

constexpr Entry locked(Entry parameter) {
  parameter.lock = Lock::kNeedsKey;
  return parameter;
}

// One of the axis's own limits.
constexpr Entry limit(R name, uint16_t object, uint32_t initial, const char* text, const char* unit) {
  return with(Effect::kAxisLimits, locked(value(name, T::kU32, object, 1, kU32Max, initial, text, unit)));
}

constexpr Entry soft_limit(R name, const char* text) {
  return with(Effect::kAxisLimits, locked(value(name, T::kI32, 0x607D, kI32Min, kI32Max, 0, text, "counts")));
}

constexpr Entry pulse_ratio(R name, uint32_t initial, const char* text) {
  return locked(value(name, T::kU32, 0, 1, kI32Max, initial, text, ""));
}

// One of a move's.
constexpr Entry profile(R name, uint16_t object, uint32_t initial, R ceiling, const char* text, const char* unit) {
  Entry parameter = value(name, T::kU32, object, 1, kU32Max, initial, text, unit);
  parameter.ceiling = ceiling;
  return parameter;
}

constexpr Entry under(R ceiling, Entry parameter) {
  parameter.ceiling = ceiling;
  return parameter;
}

// The register at `offset` of a mode's block. The reserved ones read 0 and take 0, so that a client can write the
// block.
constexpr Entry mode(uint32_t index, uint32_t offset) {
  const auto name = static_cast<R>(address_of(R::kFirstMode) + kModeStride * index + offset);
  switch (static_cast<ModeField>(offset)) {
    case ModeField::kFrequency: return value(name, T::kU32, 0, 0, 3000000, 0, "mode frequency", "1e-4 Hz", 5000);
    case ModeField::kDamping: return value(name, T::kU16, 0, 0, 30000, 0, "mode damping ratio", "1e-5");
    case ModeField::kTolerance: return value(name, T::kU16, 0, 0, 2000, 0, "mode tolerance", "0.01 %", 10);
    case ModeField::kKind: return value(name, T::kU16, 0, 0, 13, 0, "mode shaper type", "");
    case ModeField::kSpacing:
      return value(name, T::kU16, 0, 0, 5000, 0, "mode spacing of MZV's impulses", "1e-4 periods");
    default: return value(name, T::kU16, 0, 0, 0, 0, "reserved", "");
  }
}

// The same of a mode found.
constexpr Entry found(uint32_t index, uint32_t offset) {
  const R name = found_register(index, static_cast<FoundField>(offset));
  switch (static_cast<FoundField>(offset)) {
    case FoundField::kFrequency: return shown(name, T::kU32, 0, 0, "found mode: frequency", "1e-4 Hz");
    case FoundField::kDamping: return shown(name, T::kU16, 0, 0, "found mode: damping ratio", "1e-5");
    case FoundField::kAmplitude: return shown(name, T::kU16, 0, 0, "found mode: amplitude", "1/1000 of the strongest");
    case FoundField::kFrequencyStd: return shown(name, T::kU16, 0, 0, "found mode: frequency std", "1e-4 Hz");
    case FoundField::kDampingStd: return shown(name, T::kU16, 0, 0, "found mode: damping std", "1e-5");
    case FoundField::kConfidence: return shown(name, T::kU16, 0, 0, "found mode: confidence", "%");
    default: return shown(name, T::kU16, 0, 0, "reserved");
  }
}

constexpr Entry tracked(uint32_t index, uint32_t offset) {
  const R name = tracked_register(index, offset);
  return offset == 0 ? shown(name, T::kU32, 0, 0, "tracked mode: frequency (0: none)", "1e-4 Hz")
                     : shown(name, T::kU16, 0, 0, "tracked mode: damping ratio", "1e-5");
}

constexpr Entry scope_channel(uint32_t k, ScopeSource initial) {
  return value(static_cast<R>(address_of(R::kFirstScopeChannel) + k), T::kU16, 0, 0, kScopeSources - 1,
               static_cast<uint32_t>(initial), "scope: channel", "");
}

// clang-format off
constexpr Entry kTable[kParameterCount] = {
    shown(R::kMapVersion, T::kU16, 0, kMapVersion, "map version"),
    shown(R::kProduct, T::kU16, 0, kProduct, "product"),
    shown(R::kFirmwareVersion, T::kU16, 0, kFirmwareVersion, "firmware version"),
    shown(R::kBuild, T::kU16, 0, 0, "build"),
    shown(R::kUptimeMs, T::kU32, 0, 0, "uptime", "ms"),
    shown(R::kWordOrderProbe, T::kU32, 0, kWordOrderProbe, "word-order probe"),
    shown(R::kSupportedModes, T::kU32, 0x6502, kSupportedModes, "supported modes", "bits"),
    shown(R::kErrorCode, T::kU16, 0x603F, 0, "error code"),
    shown(R::kWarnings, T::kU16, 0, 0,
          "warnings (1 feedback missing, 2 servo link silent, 4 saved shaper not in force, 8 beyond a soft limit)",
          "bits"),
    shown(R::kRefusalReason, T::kU16, 0, 0, "last refusal: reason"),
    shown(R::kRefusedRegister, T::kU16, 0, 0, "last refusal: register"),
    command(R::kCommandKey, kU16Max, kAny, Effect::kCommandKey, "command key"),
    shown(R::kCommandResult, T::kU16, 0, 0, "command result"),
    shown(R::kRefusalAccepted, T::kU32, 0, 0, "last refusal: value that would be accepted"),
    shown(R::kServoTicks, T::kU32, 0, 0, "servo ticks", "ticks"),
    shown(R::kServoMissing, T::kU32, 0, 0, "servo feedbacks missing", "ticks"),
    shown(R::kServoLinkLosses, T::kU32, 0, 0, "servo link losses"),
    shown(R::kTickOverruns, T::kU32, 0, 0, "ticks not ended when the next was due", "ticks"),
    locked(value(R::kUnitId, T::kU16, 0, 1, 247, 1, "unit id, from the next start on", "")),
    locked(value(R::kBaudIndex, T::kU16, 0, 0, kBaudCount - 1, 4,
                 "baud index, from the next start on (0 9600, 1 19200, 2 38400, 3 57600, 4 115200, 5 230400, 6 460800, "
                 "7 921600)", "")),
    locked(value(R::kLineFormat, T::kU16, 0, 0, kLineFormats - 1, static_cast<uint32_t>(LineFormat::k8E1),
                 "line format, from the next start on (0 8N1, 1 8E1, 2 8O1, 3 8N2)", "")),
    with(Effect::kWatch, locked(value(R::kClientWatchdogMs, T::kU16, 0, 0, 60000, 0, "client link watchdog", "ms"))),

    with(Effect::kControlword, value(R::kControlword, T::kU16, 0x6040, 0, kU16Max, 0, "controlword", "bits")),
    shown(R::kStatusword, T::kU16, 0x6041, 0, "statusword", "bits"),
    value(R::kMode, T::kI16, 0x6060, 1, 8, 1, "mode", "", one_of(1 - 1, 3 - 1, 6 - 1) | one_of(8 - 1)),
    shown(R::kModeDisplay, T::kI16, 0x6061, 1, "mode display"),
    value(R::kTargetPosition, T::kI32, 0x607A, kI32Min, kI32Max, 0, "target position", "counts"),
    shown(R::kActualPosition, T::kI32, 0x6064, 0, "actual position", "counts"),
    shown(R::kDemandBeforeShaping, T::kI32, 0, 0, "demand before shaping", "counts"),
    shown(R::kDemandAfterShaping, T::kI32, 0x6062, 0, "demand after shaping", "counts"),
    shown(R::kFollowingError, T::kI32, 0x60F4, 0, "following error", "counts"),
    shown(R::kActualVelocity, T::kI32, 0x606C, 0, "actual velocity", "counts/s"),
    with(Effect::kVelocity,
         value(R::kTargetVelocity, T::kI32, 0x60FF, kI32Min, kI32Max, 0, "target velocity", "counts/s")),

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
    with(Effect::kWatch,
         locked(value(R::kFollowingErrorWindow, T::kU32, 0x6065, 0, kU32Max, 0, "following-error window", "counts"))),
    with(Effect::kWatch,
         locked(value(R::kFollowingErrorTimeMs, T::kU16, 0x6066, 0, kU16Max, 10, "following-error time", "ms"))),
    with(Effect::kWatch, value(R::kPositionWindow, T::kU32, 0x6067, 0, kU32Max, kMostLimitMargin,
                               "position window (up to 100 also what the position may be beyond a soft limit)",
                               "counts")),
    value(R::kPositionTimeMs, T::kU16, 0x6068, 0, kU16Max, 20, "position window time", "ms"),
    // Low at or above high: none.
    soft_limit(R::kSoftLimitLow, "soft limit low"),
    soft_limit(R::kSoftLimitHigh, "soft limit high"),
    locked(value(R::kQuickStopOption, T::kI16, 0x605A, 0, 6, 2, "quick-stop option", "",
                 one_of(0, 1, 2) | one_of(5, 6))),
    with(Effect::kWatch, locked(value(R::kFaultOption, T::kI16, 0x605E, 0, 2, 2, "fault option", ""))),

    // What a client makes revolutions of counts by; the drive itself has no use for them.
    locked(value(R::kEncoderCounts, T::kU32, 0x608F, 1, kU32Max, 1000000, "encoder: so many counts are", "counts")),
    locked(value(R::kEncoderRevolutions, T::kU32, 0x608F, 1, kU32Max, 1, "encoder: so many revolutions", "")),

    // Both take where the axis stands for home; 37 is the number that older clients know it by. Neither moves.
    value(R::kHomingMethod, T::kI16, 0x6098, 35, 37, 35, "homing method", "", one_of(35 - 35, 37 - 35)),
    profile(R::kHomingFast, 0x6099, 100000, R::kMaximumVelocity, "homing: to the switch (35, 37: not used)",
            "counts/s"),
    profile(R::kHomingSlow, 0x6099, 10000, R::kMaximumVelocity, "homing: to the zero (35, 37: not used)", "counts/s"),
    profile(R::kHomingAcceleration, 0x609A, 1000000, R::kMaximumAcceleration,
            "homing: acceleration (35, 37: not used)", "counts/s^2"),

    value(R::kStreamInterval, T::kU16, 0, 1, kMostStreamInterval, 10, "stream interval", "ticks"),
    value(R::kStreamPolicy, T::kU16, 0, 0, 1, 0, "stream policy (0 keep within the limits, 1 fault)", ""),
    shown(R::kStreamBuffered, T::kU16, 0, 0, "stream positions waiting"),
    shown(R::kStreamRoom, T::kU16, 0, kStreamPositions, "stream room"),
    shown(R::kStreamLimitedTicks, T::kU32, 0, 0, "stream limited ticks", "ticks"),
    shown(R::kStreamUnderruns, T::kU32, 0, 0, "stream underruns"),

    pulse_ratio(R::kPulseRatioPulses, 1, "pulse output, from the next start on: so many pulses are"),
    pulse_ratio(R::kPulseRatioCounts, 100, "pulse output, from the next start on: so many counts"),

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

    command(R::kTuneCommand, 4, one_of(1, 2, 3) | one_of(4), Effect::kTune,
            "auto-tune: 1 start, 2 abort, 3 accept, 4 undo"),
    value(R::kTuneExcitation, T::kU16, 0, 0, kTuneExcitations - 1, 0, "auto-tune: excitation", ""),
    value(R::kTuneAmplitude, T::kU32, 0, 1, kU32Max, 100000, "auto-tune: amplitude", "counts"),
    value(R::kTuneTravel, T::kU32, 0, 1, kU32Max, 200000, "auto-tune: travel limit, either way", "counts"),
    value(R::kTuneBandLow, T::kU16, 0, 1, kU16Max, 10, "auto-tune: band from", "0.1 Hz"),
    value(R::kTuneBandHigh, T::kU16, 0, 1, kU16Max, 2000, "auto-tune: band to", "0.1 Hz"),
    shown(R::kTuneState, T::kU16, 0, 0, "auto-tune: state"),
    shown(R::kTuneProgress, T::kU16, 0, 0, "auto-tune: progress", "%"),
    shown(R::kTuneResult, T::kU16, 0, 0, "auto-tune: result"),
    shown(R::kTuneModeCount, T::kU16, 0, 0, "auto-tune: modes found"),
    value(R::kTuneSourceWanted, T::kU16, 0, 0, kTuneSources - 1, 0, "auto-tune: source wanted", ""),
    shown(R::kTuneSourceUsed, T::kU16, 0, 0, "auto-tune: source used"),
    value(R::kTuneTolerance, T::kU16, 0, 10, 2000, 200, "auto-tune: residual wanted", "0.01 %"),
    shown(R::kTuneResidual, T::kU16, 0, 0, "auto-tune: residual predicted", "0.01 %"),
    found(0, 0), found(0, 2), found(0, 3), found(0, 4), found(0, 5), found(0, 6), found(0, 7),
    found(1, 0), found(1, 2), found(1, 3), found(1, 4), found(1, 5), found(1, 6), found(1, 7),
    found(2, 0), found(2, 2), found(2, 3), found(2, 4), found(2, 5), found(2, 6), found(2, 7),
    found(3, 0), found(3, 2), found(3, 3), found(3, 4), found(3, 5), found(3, 6), found(3, 7),
    // Of the excitation under way or done: what it will do, before it does.
    shown(R::kTuneTravelAnnounced, T::kU32, 0, 0, "auto-tune will move: at most so far", "counts"),
    shown(R::kTuneVelocityAnnounced, T::kU32, 0, 0, "auto-tune will move: peak velocity", "counts/s"),
    shown(R::kTuneAccelerationAnnounced, T::kU32, 0, 0, "auto-tune will move: peak acceleration", "counts/s^2"),
    shown(R::kTuneJerkAnnounced, T::kU32, 0, 0, "auto-tune will move: peak jerk", "1000 counts/s^3"),
    shown(R::kTuneDurationMs, T::kU32, 0, 0, "auto-tune will move: for", "ms"),
    shown(R::kTuneDelayUs, T::kU32, 0, 0, "auto-tune: delay of the shaper proposed", "us"),
    shown(R::kTuneLengthUs, T::kU32, 0, 0, "auto-tune: length of the shaper proposed", "us"),
    shown(R::kTuneGaps, T::kU32, 0, 0, "auto-tune: gaps in the record", "ticks"),
    shown(R::kTuneSaturated, T::kU32, 0, 0, "auto-tune: sensor at its end", "ticks"),
    // Root mean square, in raw steps of the accelerometer or in counts.
    shown(R::kTunePlainRinging, T::kU32, 0, 0, "auto-tune: ringing after the plain move", "1e-3 steps or counts"),
    shown(R::kTuneShapedRinging, T::kU32, 0, 0, "auto-tune: ringing after the shaped move", "1e-3 steps or counts"),
    shown(R::kTuneSourceEnough, T::kU16, 0, 0, "auto-tune: the source tells the frequency well enough"),
    shown(R::kTuneExcitedBy, T::kU16, 0, 0, "auto-tune: excitation that told, or was tried last"),
    value(R::kTuneByItself, T::kU16, 0, 0, 1, 0, "auto-tune: accept by itself", ""),
    value(R::kTuneLeadMs, T::kU16, 0, 0, kU16Max, 200, "auto-tune: from the announcement to the first motion", "ms"),
    // Raw, what it reads at its ends. Low at or above high: it has none.
    value(R::kTuneSensorLowest, T::kI32, 0, kI32Min, kI32Max, 0, "auto-tune: accelerometer's least", ""),
    value(R::kTuneSensorHighest, T::kI32, 0, kI32Min, kI32Max, 0, "auto-tune: accelerometer's most", ""),

    value(R::kTracking, T::kU16, 0, 0, 2, 0, "tracking after each move: 0 off, 1 show, 2 show and apply", ""),
    shown(R::kTrackingRefusal, T::kU16, 0, 0, "tracking: refusal reason of the last set applied"),
    shown(R::kTrackingUsed, T::kU32, 0, 0, "tracking: records that moved a mode"),
    shown(R::kTrackingLeftOut, T::kU32, 0, 0, "tracking: modes left out as outliers"),
    shown(R::kTrackingUnheard, T::kU32, 0, 0, "tracking: records that told nothing"),
    tracked(0, 0), tracked(0, kTrackedDamping), tracked(1, 0), tracked(1, kTrackedDamping),
    tracked(2, 0), tracked(2, kTrackedDamping), tracked(3, 0), tracked(3, kTrackedDamping),

    command(R::kScopeCommand, 2, kAny, Effect::kScope, "scope: 0 stop, 1 arm, 2 trigger"),
    shown(R::kScopeState, T::kU16, 0, 0, "scope: state (0 idle, 1 waiting, 2 triggered, 3 full)"),
    value(R::kScopeTrigger, T::kU16, 0, 0, 4, 0, "scope: trigger (0 by hand, 1 level, 2 motion, 3 fault, 4 rest)", ""),
    value(R::kScopeTriggerChannel, T::kU16, 0, 0, kMaxChannels - 1, 0, "scope: channel that the level is of", ""),
    value(R::kScopeLevel, T::kI32, 0, kI32Min, kI32Max, 0, "scope: level", "the channel's"),
    value(R::kScopeEdge, T::kU16, 0, 0, 2, 0, "scope: edge (0 rising, 1 falling, 2 either)", ""),
    value(R::kScopePreTrigger, T::kU16, 0, 0, 99, 10, "scope: pre-trigger", "%"),
    value(R::kScopeDecimation, T::kU16, 0, 1, kU16Max, 1, "scope: decimation", "ticks"),
    shown(R::kScopeBefore, T::kU16, 0, 0, "scope: samples before the trigger"),
    scope_channel(0, ScopeSource::kSetpoint), scope_channel(1, ScopeSource::kPosition),
    scope_channel(2, ScopeSource::kFollowingError), scope_channel(3, ScopeSource::kAccelerometer),
    shown(R::kScopeSamples, T::kU16, 0, 0, "scope: samples captured, of each channel"),
    value(R::kScopePage, T::kU16, 0, 0, 0x3FF, 0, "scope: page (channel in the high byte)", ""),
};
// clang-format on

}  // namespace stillpoint::firmware::entries
