// SPDX-License-Identifier: Apache-2.0
// The words of the enumerations that the drive's registers hold.
#pragma once

#include <cstdint>

#include "firmware/registers.hpp"
#include "firmware/state_machine.hpp"
#include "shaper/axis/axis_config.hpp"
#include "shaper/identify/capture.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint::sim {

// Null where there is no such enumerator. (Shaper kinds and findings have their text() in shaper/, excitations and
// sources theirs in sim/tuning.hpp, the drive's states theirs in sim/cli/drive_state.hpp.)
const char* text(firmware::OperationMode mode);
const char* text(firmware::StopOption option);
const char* text(firmware::ShaperState state);
const char* text(firmware::CommandKey key);
const char* text(firmware::CommandResult result);
const char* text(firmware::Tracking tracking);
const char* text(firmware::TuneCommand command);
const char* text(firmware::ScopeCommand command);
const char* text(firmware::ScopeTrigger trigger);
const char* text(firmware::ScopeEdge edge);
const char* text(firmware::ScopeSource source);
const char* text(firmware::DriveCommand command);
const char* text(TuneState state);
const char* text(CaptureState state);
const char* text(AxisPhase phase);

// What the value of a register stands for; null where it stands for itself, or the register has no such value. Command
// keys, faults, reasons and bits are not among them: see above, and register_texts.hpp.
const char* value_text(firmware::Register name, uint32_t value);

}  // namespace stillpoint::sim
