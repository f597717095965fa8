// SPDX-License-Identifier: Apache-2.0
// The firmware in the emulator finds its shaper by itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/cli/progress.hpp"
#include "sim/cli/tune_options.hpp"
#include "sim/tuning.hpp"

namespace stillpoint::cli {

struct ChipTuning {
  // What the registers tell of it, in units; amplitudes of the modes over the strongest one's.
  TuneReport report;
  Announcement first_announced;
  std::vector<sim::SpecifiedShaper> shapers;  // as the registers 0100 have them once they are kept
  std::vector<sim::TuneTick> ticks;           // from power-on on; the state as the client last saw it
  uint32_t missing_ticks;                     // as the drive counts them
  // The test image's alone, whose millisecond runs on: ticks that were not done when the next was due, and instructions
  // from the record's last sample to the proposal, the ticks' own among them.
  std::optional<uint32_t> late_ticks;
  std::optional<uint64_t> instructions;
};

// Powers the chip on, enables the drive, sets profile and excitation over Modbus as any client would, starts, accepts
// what is proposed, and waits for its end. The test image runs with a free millisecond. The drive's one register of
// amplitude is the move's distance too: with --excitation auto or move that is set. Throws a Refusal.
ChipTuning tune_on_chip(const std::string& elf, const TuneJob& job, Progress& progress);

}  // namespace stillpoint::cli
