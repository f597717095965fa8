// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_texts.hpp"

#include <fmt/format.h>

#include "firmware/registers.hpp"

namespace stillpoint::cli {

using firmware::FaultCode;

std::string hexadecimal(uint16_t value) { return fmt::format("{:04X}h", value); }

const char* text_of_fault(uint16_t code) {
  switch (static_cast<FaultCode>(code)) {
    case FaultCode::kNone: return "none";
    case FaultCode::kWatchdog: return "the watchdog has reset the chip";
    case FaultCode::kTickOverrun: return "a tick had not ended when the next was due";
    case FaultCode::kStackOverflow: return "the stack has overflowed";
    case FaultCode::kParametersBad: return "no stored parameters are whole, the defaults are in force";
    case FaultCode::kFeedbackMissing: return "three feedbacks in a row were lost or invalid";
    case FaultCode::kEncoderImplausible: return "the encoder jumped further in a tick than the axis can move";
    case FaultCode::kClientSilent: return "no client was heard within the time of 0023";
    case FaultCode::kLinkSilent: return "no servo tick came for 100 ms";
    case FaultCode::kFollowingError: return "the position left its window around the demand for too long";
    case FaultCode::kPositionLimit: return "the position is beyond a soft limit";
    case FaultCode::kStreamLimit: return "a streamed position broke the limits";
  }
  return "not known";
}

bool names_a_value(uint16_t reason) {
  return reason == firmware::kReasonOutOfRange || reason == firmware::kReasonStreamFull;
}

std::string text_of_reason(uint16_t reason) {
  switch (reason) {
    case 0: return "none";
    case firmware::kReasonLocked: return "locked, accepted after the unlock key (0014 = 554Eh)";
    case firmware::kReasonNotStanding: return "the axis moves, or something waits to take effect, accepted at rest";
    case firmware::kReasonHalted: return "the halt bit is set, accepted without it";
    case firmware::kReasonOtherMode:
      return "the set-point had not begun when another mode came into force, accepted in profile position mode";
    case firmware::kReasonNoFeedback: return "no valid position from the servo link, accepted with one";
    case firmware::kReasonNotAvailable: return "this firmware cannot do it, what its register map has is accepted";
    case firmware::kReasonOutOfRange: return "out of range";
    case firmware::kReasonStreamFull: return "no room for so many positions";
    case firmware::kReasonStreamEmpty: return "no stream, one that begins where the axis stands is accepted";
    case firmware::kReasonBroadcast: return "told to all drives, accepted by each alone";
    case firmware::kReasonNotDisabled: return "the drive is enabled, accepted while it is disabled";
    case firmware::kReasonFlashSilent:
      return "the flash does not respond or there is none, a drive with one is accepted";
    case firmware::kReasonImageVersion:
      return "the parameters were stored by a newer firmware, an image of a known version is accepted";
    case firmware::kReasonImageBad: return "no stored parameters are whole, a whole image is accepted";
    case firmware::kReasonNotEnabled: return "the drive is not enabled, accepted in operation enabled";
    case firmware::kReasonTuning: return "the auto-tune has the axis, accepted once that has ended";
    case firmware::kReasonNothingToDo: return "nothing to accept, undo, trigger or read, accepted once there is";
    default: break;
  }
  if ((reason & 0x8000U) != 0) return fmt::format("reason {} is not known here", hexadecimal(reason));
  return fmt::format("{}: {}", text(static_cast<Quantity>(reason & 0xFFU)), text(static_cast<Error>(reason >> 8)));
}

}  // namespace stillpoint::cli
