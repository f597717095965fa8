// SPDX-License-Identifier: Apache-2.0
// Addresses, keys and codes of the drive's register map, as a client sees them. Addresses never change once given.
#pragma once

#include <stdint.h>

#include "shaper/base/status.hpp"

namespace stillpoint::firmware {

// A 32-bit value takes its address and the next, high word first.
enum class Register : uint16_t {
  kMapVersion = 0x0000,
  kProduct = 0x0001,
  kFirmwareVersion = 0x0002,
  kBuild = 0x0003,
  kUptimeMs = 0x0004,
  kWordOrderProbe = 0x0006,
  kSupportedModes = 0x0008,
  kErrorCode = 0x0010,
  kWarnings = 0x0011,
  kRefusalReason = 0x0012,
  kRefusedRegister = 0x0013,
  kCommandKey = 0x0014,
  kCommandResult = 0x0015,
  kRefusalAccepted = 0x0016,
  kServoTicks = 0x0018,
  kServoMissing = 0x001A,
  kServoLinkLosses = 0x001C,
  kUnitId = 0x0020,
  kControlword = 0x0040,
  kStatusword = 0x0041,
  kMode = 0x0042,
  kModeDisplay = 0x0043,
  kTargetPosition = 0x0044,
  kActualPosition = 0x0046,
  kDemandBeforeShaping = 0x0048,
  kDemandAfterShaping = 0x004A,
  kFollowingError = 0x004C,
  kActualVelocity = 0x004E,
  kQuickStopJerk = 0x0056,
  kMaximumVelocity = 0x0058,
  kMaximumAcceleration = 0x005A,
  kMaximumJerk = 0x005C,
  kProfileVelocity = 0x0060,
  kProfileAcceleration = 0x0062,
  kProfileDeceleration = 0x0064,
  kQuickStopDeceleration = 0x0066,
  kProfileJerk = 0x0068,
  kProfileType = 0x006A,
  kFollowingErrorWindow = 0x006C,
  kFollowingErrorTimeMs = 0x006E,
  kPositionWindow = 0x0070,
  kPositionTimeMs = 0x0072,
  kSoftLimitLow = 0x0074,
  kSoftLimitHigh = 0x0076,
  kModeCount = 0x0100,
  kShaperSet = 0x0101,
  kFirstMode = 0x0102,
  kApplyShaper = 0x0130,
  kShaperState = 0x0131,
  kShaperRefusal = 0x0132,
  kActiveDelayUs = 0x0134,
  kPredictedResidual = 0x0136,
  kZeroDelay = 0x0137,
  kMoveDurationMs = 0x0138,
  kMoveProfileTicks = 0x013A,
  kMoveTotalTicks = 0x013C,
  kMoveZeroDelayMet = 0x013E,
};

constexpr Register kNoRegister = Register::kMapVersion;  // never written, so never the cause or the limit of anything

constexpr uint16_t address_of(Register name) { return static_cast<uint16_t>(name); }

// The vibration modes that a client stages, from kFirstMode on, kModeStride registers each.
constexpr uint32_t kMaxModes = 4;
constexpr uint32_t kShaperSets = 8;
constexpr uint32_t kModeStride = 8;

enum class ModeField : uint16_t {
  kFrequency = 0,
  kDamping = 2,
  kTolerance = 3,
  kKind = 4,
  kSpacing = 5,
  kReserved = 6
};

constexpr Register mode_register(uint32_t mode, ModeField field) {
  return static_cast<Register>(address_of(Register::kFirstMode) + kModeStride * mode + static_cast<uint32_t>(field));
}

constexpr uint16_t kMapVersion = 0x0100;
constexpr uint16_t kProduct = 0x5350;          // "SP"
constexpr uint16_t kFirmwareVersion = 0x0001;  // major, minor: 0.1
constexpr uint32_t kWordOrderProbe = 0x12345678;
constexpr uint32_t kSupportedModes = 0x00000001;  // 6502h: bit 0 profile position

enum class CommandKey : uint16_t {
  kUnlock = 0x554E,
  kSave = 0x5341,
  kLoadDefaults = 0x4C44,
  kReset = 0x5253,
};

enum class CommandResult : uint16_t { kIdle, kBusy, kDone, kFailed };

enum class ShaperState : uint16_t { kOff, kActive, kPending, kRefused };

// 0010 (603Fh).
enum class FaultCode : uint16_t {
  kNone = 0,
  kFeedbackMissing = 0x7300,  // sensor: three feedbacks in a row lost or invalid
  kLinkSilent = 0x8130,       // heartbeat: no servo tick for 100 ms of the own timer; a host that is too slow
};

// 0011.
constexpr uint16_t kWarningFeedbackMissing = 0x0001;  // the newest feedback was lost or invalid
constexpr uint16_t kWarningLinkSilent = 0x0002;       // no servo tick for 100 ms

// 0012. The shaper's own refusals are its error in the high byte and the quantity in the low byte; what the drive
// itself refuses has bit 15 set.
constexpr uint16_t kReasonLocked = 0x8000;        // needs the unlock key
constexpr uint16_t kReasonNotStanding = 0x8100;   // the axis moves, or something waits to take effect
constexpr uint16_t kReasonHalted = 0x8200;        // the controlword's halt bit is set
constexpr uint16_t kReasonNoFeedback = 0x8300;    // the servo link gives no valid position: operation not enabled
constexpr uint16_t kReasonNotAvailable = 0x8400;  // this firmware cannot do it
constexpr uint16_t kReasonOutOfRange = 0x8500;    // exception 03: 0016 has the nearest value accepted
constexpr uint16_t kReasonBroadcast = 0x8700;     // all drives were told; only each by itself can be
constexpr uint16_t kReasonNotDisabled = 0x8800;   // only while the drive is disabled
constexpr uint16_t kReasonFlashSilent = 0x8900;   // the flash does not respond, or there is none
constexpr uint16_t kReasonImageVersion = 0x8A00;  // at the start: parameters stored by an unknown, newer firmware
constexpr uint16_t kReasonImageBad = 0x8A01;      // at the start: no stored parameters are whole

constexpr uint16_t reason_of(Error error, Quantity quantity) {
  return static_cast<uint16_t>((static_cast<uint32_t>(error) << 8) | static_cast<uint32_t>(quantity));
}

}  // namespace stillpoint::firmware
