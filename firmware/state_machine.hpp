// SPDX-License-Identifier: Apache-2.0
// CiA 402's states (IEC 61800-7-201) as pure functions: what a controlword asks for, where that leads, how the state
// reads in the statusword. Any context.
#pragma once

#include <stdint.h>

namespace stillpoint::firmware {

enum class DriveState : uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReady,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReaction,
  kFault,
};

enum class DriveCommand : uint8_t { kShutdown, kSwitchOn, kEnableOperation, kDisableVoltage, kQuickStop };

constexpr uint16_t kControlNewSetPoint = 1U << 4;
constexpr uint16_t kControlAtOnce = 1U << 5;
constexpr uint16_t kControlRelative = 1U << 6;
constexpr uint16_t kControlFaultReset = 1U << 7;
constexpr uint16_t kControlHalt = 1U << 8;

constexpr uint16_t kStatusVoltageEnabled = 1U << 4;
constexpr uint16_t kStatusWarning = 1U << 7;
constexpr uint16_t kStatusRemote = 1U << 9;
constexpr uint16_t kStatusTargetReached = 1U << 10;
// A soft limit holds what should move at a velocity, or the position is beyond one.
constexpr uint16_t kStatusInternalLimit = 1U << 11;
// Bit 12 by mode: the set-point is taken, the velocity is 0, home is known, the stream is followed. Bit 13:
// the position has left its window for its time (6065h, 6066h), which is a fault here, until that is reset; homing
// failed.
constexpr uint16_t kStatusSetPointTaken = 1U << 12;
constexpr uint16_t kStatusVelocityZero = 1U << 12;
constexpr uint16_t kStatusHomed = 1U << 12;
constexpr uint16_t kStatusFollowingError = 1U << 13;
constexpr uint16_t kStatusHomingError = 1U << 13;

// The level command in bits 0-3; every pattern is one of them. (Fault reset is an edge, see drive.hpp.)
constexpr DriveCommand command_of(uint16_t controlword) {
  if ((controlword & 0x02U) == 0) return DriveCommand::kDisableVoltage;
  if ((controlword & 0x04U) == 0) return DriveCommand::kQuickStop;
  if ((controlword & 0x01U) == 0) return DriveCommand::kShutdown;
  return (controlword & 0x08U) == 0 ? DriveCommand::kSwitchOn : DriveCommand::kEnableOperation;
}

// One transition; `state` itself where the command means nothing there. Quick stop active leads nowhere but out
// (option 2 of 605Ah); faults are left by the drive itself.
DriveState next_state(DriveState state, DriveCommand command);

// Bits 0-3, 5 and 6 of the statusword.
uint16_t status_bits(DriveState state);

}  // namespace stillpoint::firmware
