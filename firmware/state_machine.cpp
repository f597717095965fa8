// SPDX-License-Identifier: Apache-2.0
#include "firmware/state_machine.hpp"

namespace stillpoint::firmware {
namespace {

// The numbers are CiA 402's own for the transitions.
DriveState from_ready(DriveCommand command) {
  switch (command) {
    case DriveCommand::kSwitchOn:
    case DriveCommand::kEnableOperation: return DriveState::kSwitchedOn;  // 3; enabling goes on with 4
    case DriveCommand::kDisableVoltage:
    case DriveCommand::kQuickStop: return DriveState::kSwitchOnDisabled;  // 7
    case DriveCommand::kShutdown: break;
  }
  return DriveState::kReady;
}

DriveState from_switched_on(DriveCommand command) {
  switch (command) {
    case DriveCommand::kEnableOperation: return DriveState::kOperationEnabled;  // 4
    case DriveCommand::kShutdown: return DriveState::kReady;                    // 6
    case DriveCommand::kDisableVoltage:
    case DriveCommand::kQuickStop: return DriveState::kSwitchOnDisabled;  // 10
    case DriveCommand::kSwitchOn: break;
  }
  return DriveState::kSwitchedOn;
}

DriveState from_operation_enabled(DriveCommand command) {
  switch (command) {
    case DriveCommand::kSwitchOn: return DriveState::kSwitchedOn;              // 5
    case DriveCommand::kShutdown: return DriveState::kReady;                   // 8
    case DriveCommand::kDisableVoltage: return DriveState::kSwitchOnDisabled;  // 9
    case DriveCommand::kQuickStop: return DriveState::kQuickStopActive;        // 11
    case DriveCommand::kEnableOperation: break;
  }
  return DriveState::kOperationEnabled;
}

}  // namespace

DriveState next_state(DriveState state, DriveCommand command) {
  switch (state) {
    case DriveState::kSwitchOnDisabled: return command == DriveCommand::kShutdown ? DriveState::kReady : state;  // 2
    case DriveState::kReady: return from_ready(command);
    case DriveState::kSwitchedOn: return from_switched_on(command);
    case DriveState::kOperationEnabled: return from_operation_enabled(command);
    case DriveState::kQuickStopActive:
      return command == DriveCommand::kDisableVoltage ? DriveState::kSwitchOnDisabled : state;  // 12
    case DriveState::kNotReady:
    case DriveState::kFaultReaction:
    case DriveState::kFault: break;
  }
  return state;
}

uint16_t status_bits(DriveState state) {
  switch (state) {
    case DriveState::kNotReady: break;
    case DriveState::kSwitchOnDisabled: return 0x0040;
    case DriveState::kReady: return 0x0021;
    case DriveState::kSwitchedOn: return 0x0023;
    case DriveState::kOperationEnabled: return 0x0027;
    case DriveState::kQuickStopActive: return 0x0007;
    case DriveState::kFaultReaction: return 0x000F;
    case DriveState::kFault: return 0x0008;
  }
  return 0x0000;
}

}  // namespace stillpoint::firmware
