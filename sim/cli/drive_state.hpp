// SPDX-License-Identifier: Apache-2.0
// A drive's CiA 402 state, as its statusword has it, and the controlwords that lead from one to another.
#pragma once

#include <cstdint>

#include "firmware/state_machine.hpp"

namespace stillpoint::cli {

constexpr uint16_t kDisableVoltage = 0x00;
constexpr uint16_t kQuickStop = 0x02;
constexpr uint16_t kShutdown = 0x06;
constexpr uint16_t kSwitchOn = 0x07;
constexpr uint16_t kEnableOperation = 0x0F;

firmware::DriveState state_of(uint16_t statusword);
const char* text(firmware::DriveState state);

}  // namespace stillpoint::cli
