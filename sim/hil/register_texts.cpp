// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/register_texts.hpp"

#include "firmware/control_loop.hpp"
#include "firmware/state_machine.hpp"

namespace stillpoint::sim {

using firmware::FaultCode;

namespace {

// No default: the compiler asks for a new code.
std::string when_seen(FaultCode code) {
  switch (code) {
    case FaultCode::kNone: break;
    case FaultCode::kWatchdog:
    case FaultCode::kParametersBad: return "at the start";
    case FaultCode::kTickOverrun: return "enabled, two in a row";
    case FaultCode::kStackOverflow: return "at any time";
    case FaultCode::kFeedbackMissing: return "enabled";
    case FaultCode::kEncoderImplausible: return "enabled, by more than 1000 counts and twice what 0058 allows";
    case FaultCode::kClientSilent: return "enabled; 0023 at 0: never";
    case FaultCode::kLinkSilent: return "enabled";
    case FaultCode::kFollowingError:
      return "enabled, beyond 006C for longer than 006E; 0: never. Or, with pulse output, more pulses than it can send";
    case FaultCode::kPositionLimit:
      return "enabled, beyond 0074 or 0076, or further out than it was enabled at, by more than 0070 or 100 counts for "
             "longer than 006E";
    case FaultCode::kStreamLimit: return "with 1 in 0089";
  }
  return "";
}

}  // namespace

FaultText fault_text(FaultCode code) {
  FaultText all = {when_seen(code), "0079", "edge"};
  switch (code) {
    case FaultCode::kWatchdog:
    case FaultCode::kParametersBad: all.reaction = "none, it is off"; break;
    case FaultCode::kStackOverflow: all.reset = "restart"; break;
    case FaultCode::kLinkSilent:
      all.reaction = "0079, a ramp being a quick stop; off after " + std::to_string(firmware::kSilentMsAbandon) +
                     " ms without a tick";
      break;
    default: break;
  }
  return all;
}

const char* warning_text(uint32_t mask) {
  switch (mask) {
    case firmware::kWarningFeedbackMissing: return "the newest feedback was lost or invalid";
    case firmware::kWarningLinkSilent: return "no servo tick comes";
    case firmware::kWarningNotRestored: return "the shaper that was saved is not in force: not yet, or refused";
    case firmware::kWarningBeyondLimit: return "the position is beyond a soft limit";
    default: return nullptr;
  }
}

const char* scope_flag_text(uint32_t mask) {
  switch (mask) {
    case firmware::kScopeEnabled: return "enabled";
    case firmware::kScopeFeedbackValid: return "the feedback is valid";
    case firmware::kScopeInWindow: return "at rest, the position in its window";
    default: return nullptr;
  }
}

const char* control_text(uint32_t mask) {
  switch (mask) {
    case firmware::kControlNewSetPoint:
      return "its edge, only in operation enabled: a set-point is taken (profile position), homing, the stream begins. "
             "Its fall ends the stream by the profile's ramp. None in profile velocity";
    case firmware::kControlAtOnce:
      return "profile position: a set-point in motion takes over in flight; without, it is kept until the axis stands";
    case firmware::kControlRelative:
      return "profile position: 0044 counts from the target of the move under way, or from where the axis stands";
    case firmware::kControlFaultReset: return "its edge, only in fault: reset";
    case firmware::kControlHalt:
      return "halt: ramp by the profile's limits through the shaper. A move is given up, a velocity goes on "
             "afterwards; "
             "while it is set no set-point is taken";
    default: return nullptr;
  }
}

const char* status_text(uint32_t mask) {
  switch (mask) {
    case firmware::kStatusVoltageEnabled: return "voltage enabled: servo ticks come";
    case firmware::kStatusWarning: return "warning: 0011 is not 0";
    case firmware::kStatusRemote: return "remote: always 1";
    case firmware::kStatusTargetReached:
      return "target reached: the shaper has drained, nothing waits, and the position has stayed within 0070 for 0072; "
             "not after a move that was given up, but after a halt. In profile velocity the setpoint has the velocity";
    case firmware::kStatusInternalLimit:
      return "internal limit: a soft limit holds the velocity asked for, or the position is beyond one";
    case firmware::kStatusSetPointTaken:  // and the other modes' of that bit
      return "profile position: the set-point is taken, until bit 4 falls and, where it is kept, it begins. Profile "
             "velocity: stands. Homing: done, until the next or another mode. Stream: followed exactly";
    case firmware::kStatusHomingError:  // and the other mode's of that bit
      return "profile position: the position has been out of 006C for longer than 006E, until that fault is reset. "
             "Homing: refused, the axis moved";
    default: return nullptr;
  }
}

}  // namespace stillpoint::sim
