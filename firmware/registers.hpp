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
  kTickOverruns = 0x001E,
  kUnitId = 0x0020,
  kBaudIndex = 0x0021,
  kLineFormat = 0x0022,
  kClientWatchdogMs = 0x0023,
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
  kTargetVelocity = 0x0052,
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
  kQuickStopOption = 0x0078,
  kFaultOption = 0x0079,
  kEncoderCounts = 0x007C,
  kEncoderRevolutions = 0x007E,
  kHomingMethod = 0x0080,
  kHomingFast = 0x0082,
  kHomingSlow = 0x0084,
  kHomingAcceleration = 0x0086,
  kStreamInterval = 0x0088,
  kStreamPolicy = 0x0089,
  kStreamBuffered = 0x008A,
  kStreamRoom = 0x008B,
  kStreamLimitedTicks = 0x008C,
  kStreamUnderruns = 0x008E,
  kPulseRatioPulses = 0x00D0,
  kPulseRatioCounts = 0x00D2,
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
  kTuneCommand = 0x0200,
  kTuneExcitation = 0x0201,
  kTuneAmplitude = 0x0202,
  kTuneTravel = 0x0204,
  kTuneBandLow = 0x0206,
  kTuneBandHigh = 0x0207,
  kTuneState = 0x0208,
  kTuneProgress = 0x0209,
  kTuneResult = 0x020A,
  kTuneModeCount = 0x020B,
  kTuneSourceWanted = 0x020C,
  kTuneSourceUsed = 0x020D,
  kTuneTolerance = 0x020E,
  kTuneResidual = 0x020F,
  kFirstFoundMode = 0x0210,
  kTuneTravelAnnounced = 0x0230,
  kTuneVelocityAnnounced = 0x0232,
  kTuneAccelerationAnnounced = 0x0234,
  kTuneJerkAnnounced = 0x0236,
  kTuneDurationMs = 0x0238,
  kTuneDelayUs = 0x023A,
  kTuneLengthUs = 0x023C,
  kTuneGaps = 0x023E,
  kTuneSaturated = 0x0240,
  kTunePlainRinging = 0x0242,
  kTuneShapedRinging = 0x0244,
  kTuneSourceEnough = 0x0246,
  kTuneExcitedBy = 0x0247,
  kTuneByItself = 0x0248,
  kTuneLeadMs = 0x0249,
  kTuneSensorLowest = 0x024A,
  kTuneSensorHighest = 0x024C,
  kTracking = 0x0250,
  kTrackingRefusal = 0x0251,
  kTrackingUsed = 0x0252,
  kTrackingLeftOut = 0x0254,
  kTrackingUnheard = 0x0256,
  kFirstTrackedMode = 0x0260,
  kScopeCommand = 0x0300,
  kScopeState = 0x0301,
  kScopeTrigger = 0x0302,
  kScopeTriggerChannel = 0x0303,
  kScopeLevel = 0x0304,
  kScopeEdge = 0x0306,
  kScopePreTrigger = 0x0307,
  kScopeDecimation = 0x0308,
  kScopeBefore = 0x0309,
  kFirstScopeChannel = 0x030A,
  kScopeSamples = 0x0310,
  kScopePage = 0x0311,
};

constexpr Register kNoRegister = Register::kMapVersion;  // never written, so never the cause or the limit of anything

constexpr uint16_t address_of(Register name) { return static_cast<uint16_t>(name); }

// The vibration modes that a client stages, from kFirstMode on, kModeStride registers each.
constexpr uint32_t kMaxModes = 4;
constexpr uint32_t kShaperSets = 8;
constexpr uint32_t kModeStride = 8;

// Write-only, by function 16 from here on: the next positions of the stream, two registers each, at most kStreamWindow.
constexpr uint16_t kFirstStreamPosition = 0x0090;
constexpr uint32_t kStreamWindow = 32;

// The scope's window: a page of one channel, kScopePage samples of two registers.
constexpr uint16_t kFirstScopeWord = 0x0400;
constexpr uint32_t kScopePage = 62;

// The fault history: sixteen registers an entry, the newest first; see FaultLog::word.
constexpr uint16_t kFirstFaultEntry = 0x0500;
constexpr uint32_t kFaultEntryStride = 16;

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

// The modes that an auto-tune found, from kFirstFoundMode on, as far apart.
enum class FoundField : uint16_t {
  kFrequency = 0,
  kDamping = 2,
  kAmplitude = 3,
  kFrequencyStd = 4,
  kDampingStd = 5,
  kConfidence = 6,
  kReserved = 7
};

constexpr Register found_register(uint32_t mode, FoundField field) {
  return static_cast<Register>(address_of(Register::kFirstFoundMode) + kModeStride * mode +
                               static_cast<uint32_t>(field));
}

// The modes that are followed, from kFirstTrackedMode on, kTrackedStride registers each: frequency, damping ratio.
constexpr uint32_t kTrackedStride = 4;
constexpr uint32_t kTrackedDamping = 2;

constexpr Register tracked_register(uint32_t mode, uint32_t offset) {
  return static_cast<Register>(address_of(Register::kFirstTrackedMode) + kTrackedStride * mode + offset);
}

// 0250.
enum class Tracking : uint16_t { kOff, kShow, kApply };

enum class TuneCommand : uint16_t { kStart = 1, kAbort = 2, kAccept = 3, kUndo = 4 };

enum class ScopeCommand : uint16_t { kStop, kArm, kTrigger };
enum class ScopeTrigger : uint16_t { kByHand, kLevel, kMotion, kFault, kRest };
enum class ScopeEdge : uint16_t { kRising, kFalling, kEither };

// What a channel shows, each as of one tick. Counts and counts/s but for those that say otherwise.
enum class ScopeSource : uint16_t {
  kNone,
  kDemand,            // before shaping
  kSetpoint,          // after shaping
  kPosition,          // newest valid feedback
  kFollowingError,    // 0 while disabled
  kDemandVelocity,    // since the tick before
  kSetpointVelocity,  // since the tick before
  kVelocity,          // of the feedback
  kAccelerometer,     // raw steps
  kPhase,             // AxisPhase: at rest 0, moving 1, draining the shaper 2, stopping 3, streaming 4
  kFault,             // the code of 0010
  kFlags              // the bits below
};
constexpr uint32_t kScopeSources = 12;
constexpr uint16_t kScopeEnabled = 0x0001;
constexpr uint16_t kScopeFeedbackValid = 0x0002;
constexpr uint16_t kScopeInWindow = 0x0004;  // at rest, the position in its window

constexpr uint16_t kMapVersion = 0x0100;
constexpr uint16_t kProduct = 0x5350;          // "SP"
constexpr uint16_t kFirmwareVersion = 0x0001;  // major, minor: 0.1
constexpr uint32_t kWordOrderProbe = 0x12345678;
constexpr uint32_t kSupportedModes = 0x000000A5;  // 6502h: profile position, profile velocity, homing, stream

enum class CommandKey : uint16_t {
  kUnlock = 0x554E,
  kSave = 0x5341,
  kLoadDefaults = 0x4C44,
  kReset = 0x5253,
};

enum class CommandResult : uint16_t { kIdle, kBusy, kDone, kFailed };

// 6060h.
enum class OperationMode : uint16_t { kProfilePosition = 1, kProfileVelocity = 3, kHoming = 6, kStream = 8 };

enum class ShaperState : uint16_t { kOff, kActive, kPending, kRefused };

// 0010 (603Fh), and in the fault history. All latch until they are reset; the reaction is 0079's.
enum class FaultCode : uint16_t {
  kNone = 0,
  kWatchdog = 0x6010,            // software reset: the watchdog bit, noted at the start after it
  kTickOverrun = 0x6100,         // internal software: a tick had not ended when the next was due
  kStackOverflow = 0x6101,       // internal software: the guard below the stack is not what it was
  kParametersBad = 0x6310,       // loss of parameters: neither stored image is sound; the defaults are in force
  kFeedbackMissing = 0x7300,     // sensor: three feedbacks in a row lost or invalid
  kEncoderImplausible = 0x7305,  // incremental sensor 1: it moved further in a tick than the axis can
  kClientSilent = 0x8100,        // communication: no request within the time of 0023
  kLinkSilent = 0x8130,          // heartbeat: no servo tick for 100 ms of the own timer; a host that is too slow
  kFollowingError = 0x8611,      // the position left its window around the shaped demand for too long
  kPositionLimit = 0x8612,       // reference limit: the position passed a soft limit outwards
  kStreamLimit = 0xFF01,         // a streamed position broke the limits, and 0089 asks for a fault then
};

// 605Ah and 605Eh. The ramp is the profile's and goes through the shaper, so it ends still; the quick stop does not
// wait for that. `Stay`: in quick stop active, until told to go on.
enum class StopOption : uint16_t { kOff, kRamp, kQuick, kRampAndStay = 5, kQuickAndStay = 6 };

// 0011.
constexpr uint16_t kWarningFeedbackMissing = 0x0001;  // the newest feedback was lost or invalid
constexpr uint16_t kWarningLinkSilent = 0x0002;       // no servo tick for 100 ms
constexpr uint16_t kWarningNotRestored = 0x0004;      // the shaper that was saved is not in force: not yet, or refused
constexpr uint16_t kWarningBeyondLimit = 0x0008;      // the position is beyond a soft limit

// 0012. The shaper's own refusals are its error in the high byte and the quantity in the low byte; what the drive
// itself refuses has bit 15 set.
constexpr uint16_t kReasonLocked = 0x8000;        // needs the unlock key
constexpr uint16_t kReasonNotStanding = 0x8100;   // the axis moves, or something waits to take effect
constexpr uint16_t kReasonHalted = 0x8200;        // the controlword's halt bit is set
constexpr uint16_t kReasonOtherMode = 0x8201;     // the set-point had not begun when another mode came into force
constexpr uint16_t kReasonNoFeedback = 0x8300;    // the servo link gives no valid position: operation not enabled
constexpr uint16_t kReasonNotAvailable = 0x8400;  // this firmware cannot do it
constexpr uint16_t kReasonStreamFull = 0x8600;    // no room for so many positions: 0016 has how many
constexpr uint16_t kReasonStreamEmpty = 0x8601;   // a stream begins with a position where the axis stands
constexpr uint16_t kReasonOutOfRange = 0x8500;    // exception 03: 0016 has the nearest value accepted
constexpr uint16_t kReasonBroadcast = 0x8700;     // all drives were told; only each by itself can be
constexpr uint16_t kReasonNotDisabled = 0x8800;   // only while the drive is disabled
constexpr uint16_t kReasonFlashSilent = 0x8900;   // the flash does not respond, or there is none
constexpr uint16_t kReasonImageVersion = 0x8A00;  // at the start: parameters stored later by an unknown, newer firmware
constexpr uint16_t kReasonImageBad = 0x8A01;      // at the start: no stored parameters are whole
constexpr uint16_t kReasonNotEnabled = 0x9000;    // only in operation enabled
constexpr uint16_t kReasonTuning = 0x9100;        // the auto-tune has the axis
constexpr uint16_t kReasonNothingToDo = 0x9200;   // to accept or undo (auto-tune), to trigger or, then, read (scope)

constexpr uint16_t reason_of(Error error, Quantity quantity) {
  return static_cast<uint16_t>((static_cast<uint32_t>(error) << 8) | static_cast<uint32_t>(quantity));
}

}  // namespace stillpoint::firmware
