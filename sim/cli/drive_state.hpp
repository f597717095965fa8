// SPDX-License-Identifier: Apache-2.0
// A drive's CiA 402 state, as its statusword has it.
#pragma once

#include <cstdint>

#include "firmware/state_machine.hpp"

namespace stillpoint::cli {

firmware::DriveState state_of(uint16_t statusword);
const char* text(firmware::DriveState state);

}  // namespace stillpoint::cli
