// SPDX-License-Identifier: Apache-2.0
// The switches have no default: the compiler asks for the words of a new enumerator.
#include "sim/hil/value_texts.hpp"

#include <iterator>

#include "sim/tuning.hpp"

namespace stillpoint::sim {

using firmware::CommandKey;
using firmware::CommandResult;
using firmware::DriveCommand;
using firmware::OperationMode;
using firmware::Register;
using firmware::ScopeCommand;
using firmware::ScopeEdge;
using firmware::ScopeSource;
using firmware::ScopeTrigger;
using firmware::ShaperState;
using firmware::StopOption;
using firmware::Tracking;
using firmware::TuneCommand;

const char* text(OperationMode mode) {
  switch (mode) {
    case OperationMode::kProfilePosition: return "profile position";
    case OperationMode::kProfileVelocity: return "profile velocity";
    case OperationMode::kHoming: return "homing";
    case OperationMode::kStream: return "stream of positions";
  }
  return nullptr;
}

const char* text(StopOption option) {
  switch (option) {
    case StopOption::kOff: return "off at once";
    case StopOption::kRamp: return "ramp by the profile's limits, through the shaper, then off";
    case StopOption::kQuick: return "ramp by the quick-stop limits, not shaped, then off";
    case StopOption::kRampAndStay: return "as 1, then quick stop active until told to go on";
    case StopOption::kQuickAndStay: return "as 2, then quick stop active until told to go on";
  }
  return nullptr;
}

const char* text(ShaperState state) {
  switch (state) {
    case ShaperState::kOff: return "off";
    case ShaperState::kActive: return "active";
    case ShaperState::kPending: return "pending (designed, or waiting for the axis)";
    case ShaperState::kRefused: return "refused (0132; what was in force still is)";
  }
  return nullptr;
}

const char* text(CommandKey key) {
  switch (key) {
    case CommandKey::kUnlock: return "unlock";
    case CommandKey::kSave: return "save the parameters";
    case CommandKey::kLoadDefaults: return "load the defaults (not saved by it)";
    case CommandKey::kReset: return "restart the drive";
  }
  return nullptr;
}

const char* text(CommandResult result) {
  switch (result) {
    case CommandResult::kIdle: return "idle";
    case CommandResult::kBusy: return "busy";
    case CommandResult::kDone: return "done";
    case CommandResult::kFailed: return "failed (0012)";
  }
  return nullptr;
}

const char* text(Tracking tracking) {
  switch (tracking) {
    case Tracking::kOff: return "off";
    case Tracking::kShow: return "show";
    case Tracking::kApply: return "show and apply";
  }
  return nullptr;
}

const char* text(TuneCommand command) {
  switch (command) {
    case TuneCommand::kStart: return "start";
    case TuneCommand::kAbort: return "abort";
    case TuneCommand::kAccept: return "accept what is proposed: apply, then verify";
    case TuneCommand::kUndo: return "undo: drop what is proposed, or take off what was kept";
  }
  return nullptr;
}

const char* text(ScopeCommand command) {
  switch (command) {
    case ScopeCommand::kStop: return "stop";
    case ScopeCommand::kArm: return "arm";
    case ScopeCommand::kTrigger: return "trigger";
  }
  return nullptr;
}

const char* text(ScopeTrigger trigger) {
  switch (trigger) {
    case ScopeTrigger::kByHand: return "by hand (0300)";
    case ScopeTrigger::kLevel: return "level (0303 to 0306)";
    case ScopeTrigger::kMotion: return "a motion begins";
    case ScopeTrigger::kFault: return "fault";
    case ScopeTrigger::kRest: return "the axis comes to rest";
  }
  return nullptr;
}

const char* text(ScopeEdge edge) {
  switch (edge) {
    case ScopeEdge::kRising: return "rising";
    case ScopeEdge::kFalling: return "falling";
    case ScopeEdge::kEither: return "either";
  }
  return nullptr;
}

const char* text(ScopeSource source) {
  switch (source) {
    case ScopeSource::kNone: return "none, nor any after it";
    case ScopeSource::kDemand: return "demand before shaping [counts]";
    case ScopeSource::kSetpoint: return "setpoint, after shaping [counts]";
    case ScopeSource::kPosition: return "position, the newest valid [counts]";
    case ScopeSource::kFollowingError: return "following error [counts], 0 while disabled";
    case ScopeSource::kDemandVelocity: return "the demand's velocity [counts/s]";
    case ScopeSource::kSetpointVelocity: return "the setpoint's velocity [counts/s]";
    case ScopeSource::kVelocity: return "the position's velocity [counts/s]";
    case ScopeSource::kAccelerometer: return "accelerometer [raw steps]";
    case ScopeSource::kPhase: return "phase of the axis";
    case ScopeSource::kFault: return "fault code (0010)";
    case ScopeSource::kFlags: return "flags";
  }
  return nullptr;
}

const char* text(DriveCommand command) {
  switch (command) {
    case DriveCommand::kShutdown: return "shutdown";
    case DriveCommand::kSwitchOn: return "switch on";
    case DriveCommand::kEnableOperation: return "enable operation";
    case DriveCommand::kDisableVoltage: return "disable voltage";
    case DriveCommand::kQuickStop: return "quick stop";
  }
  return nullptr;
}

const char* text(TuneState state) {
  switch (state) {
    case TuneState::kIdle: return "idle";
    case TuneState::kExciting: return "exciting";
    case TuneState::kCapturing: return "capturing";
    case TuneState::kIdentifying: return "identifying";
    case TuneState::kProposed: return "proposed (waits for accept, undo or abort)";
    case TuneState::kApplying: return "applying";
    case TuneState::kVerifying: return "verifying";
    case TuneState::kKept: return "kept";
    case TuneState::kUndone: return "undone (the shaper of before is in force)";
    case TuneState::kFailed: return "failed (020A; the shaper of before is in force)";
  }
  return nullptr;
}

const char* text(CaptureState state) {
  switch (state) {
    case CaptureState::kIdle: return "idle";
    case CaptureState::kWaiting: return "waiting";
    case CaptureState::kRunning: return "triggered";
    case CaptureState::kFull: return "full";
  }
  return nullptr;
}

const char* text(AxisPhase phase) {
  switch (phase) {
    case AxisPhase::kAtRest: return "at rest";
    case AxisPhase::kMoving: return "moving";
    case AxisPhase::kDraining: return "draining the shaper";
    case AxisPhase::kStopping: return "stopping";
    case AxisPhase::kStreaming: return "streaming";
  }
  return nullptr;
}

namespace {

// Registers whose values have no enumeration; the table has the numbers that are accepted.
const char* profile_type_text(uint32_t value) {
  constexpr const char* kTexts[] = {"trapezoid", "sin^2", nullptr, "jerk-limited"};
  return value < std::size(kTexts) ? kTexts[value] : nullptr;
}

const char* homing_text(uint32_t value) {
  if (value == 35) return "the place where it stands becomes position 0, without motion";
  return value == 37 ? "the same" : nullptr;
}

const char* stream_policy_text(uint32_t value) {
  constexpr const char* kTexts[] = {"keep within the limits, and catch up", "fault FF01 where a position breaks them"};
  return value < std::size(kTexts) ? kTexts[value] : nullptr;
}

const char* finding_text(uint32_t value) {
  return value <= static_cast<uint32_t>(Finding::kAborted) ? stillpoint::text(static_cast<Finding>(value)) : nullptr;
}

const char* kind_text(uint32_t value) {
  return value < kShaperKinds ? stillpoint::text(static_cast<ShaperKind>(value)) : nullptr;
}

template <typename Enumeration>
const char* text_as(uint32_t value) {
  return text(static_cast<Enumeration>(value));
}

bool is_kind_of_mode(Register name) {
  for (uint32_t k = 0; k < firmware::kMaxModes; ++k) {
    if (name == firmware::mode_register(k, firmware::ModeField::kKind)) return true;
  }
  return false;
}

bool is_scope_channel(Register name) {
  const uint32_t first = address_of(Register::kFirstScopeChannel);
  return address_of(name) >= first && address_of(name) < first + kMaxChannels;
}

}  // namespace

const char* value_text(Register name, uint32_t value) {
  if (is_kind_of_mode(name)) return kind_text(value);
  if (is_scope_channel(name)) return value < firmware::kScopeSources ? text_as<ScopeSource>(value) : nullptr;
  if (value > UINT8_MAX) return nullptr;  // what the narrowest of them holds
  switch (name) {
    case Register::kCommandResult: return text_as<CommandResult>(value);
    case Register::kMode:
    case Register::kModeDisplay: return text_as<OperationMode>(value);
    case Register::kProfileType: return profile_type_text(value);
    case Register::kQuickStopOption:
    case Register::kFaultOption: return text_as<StopOption>(value);
    case Register::kHomingMethod: return homing_text(value);
    case Register::kStreamPolicy: return stream_policy_text(value);
    case Register::kShaperState: return text_as<ShaperState>(value);
    case Register::kTuneCommand: return text_as<TuneCommand>(value);
    case Register::kTuneExcitation:
    case Register::kTuneExcitedBy: return value < kTuneExcitations ? text_as<TuneExcitation>(value) : nullptr;
    case Register::kTuneState: return text_as<TuneState>(value);
    case Register::kTuneResult: return finding_text(value);
    case Register::kTuneSourceWanted:
    case Register::kTuneSourceUsed: return value < kTuneSources ? text_as<TuneSource>(value) : nullptr;
    case Register::kTracking: return text_as<Tracking>(value);
    case Register::kScopeCommand: return text_as<ScopeCommand>(value);
    case Register::kScopeState: return text_as<CaptureState>(value);
    case Register::kScopeTrigger: return text_as<ScopeTrigger>(value);
    case Register::kScopeEdge: return text_as<ScopeEdge>(value);
    default: return nullptr;
  }
}

}  // namespace stillpoint::sim
