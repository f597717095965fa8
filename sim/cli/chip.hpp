// SPDX-License-Identifier: Apache-2.0
// Moves of the firmware in the emulator.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sim/cli/move_job.hpp"
#include "sim/cli/progress.hpp"

namespace stillpoint::cli {

struct ChipRun {
  sim::Recording recording;  // setpoints from the one before the first change to the last change
  uint64_t locked_ticks;     // all of them, from power-on on
  // What the test image says of the ticks in which the setpoint moved.
  std::optional<double> instructions_per_tick;
  uint32_t most_instructions;
  uint32_t late_ticks;
};

// Powers the chip on, enables the drive, sets shaper and move over Modbus as any client would, and records what comes
// over the servo link until the drive reports the target reached. `specs` and `task` as `rounded` has them. Throws a
// Refusal: of the emulator, of the client line, or with the drive's own reason.
ChipRun run_on_chip(const std::string& elf, const sim::MoveTask& task, const std::vector<sim::SpecifiedShaper>& specs,
                    const sim::ArmModes& arm, Progress& progress);

}  // namespace stillpoint::cli
