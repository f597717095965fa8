// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_state.hpp"

#include <initializer_list>

namespace stillpoint::cli {

using firmware::DriveState;

DriveState state_of(uint16_t statusword) {
  // Bit 5 tells nothing where the drive is off or in a fault.
  const auto coarse = static_cast<uint16_t>(statusword & 0x4F);
  for (const DriveState state : {DriveState::kSwitchOnDisabled, DriveState::kFaultReaction, DriveState::kFault})
    if (coarse == firmware::status_bits(state)) return state;
  const auto fine = static_cast<uint16_t>(statusword & 0x6F);
  for (const DriveState state :
       {DriveState::kReady, DriveState::kSwitchedOn, DriveState::kOperationEnabled, DriveState::kQuickStopActive})
    if (fine == firmware::status_bits(state)) return state;
  return DriveState::kNotReady;
}

const char* text(DriveState state) {
  switch (state) {
    case DriveState::kNotReady: return "not ready to switch on";
    case DriveState::kSwitchOnDisabled: return "switch on disabled";
    case DriveState::kReady: return "ready to switch on";
    case DriveState::kSwitchedOn: return "switched on";
    case DriveState::kOperationEnabled: return "operation enabled";
    case DriveState::kQuickStopActive: return "quick stop active";
    case DriveState::kFaultReaction: return "fault reaction active";
    case DriveState::kFault: return "fault";
  }
  return "";
}

}  // namespace stillpoint::cli
