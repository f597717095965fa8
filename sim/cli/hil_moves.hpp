// SPDX-License-Identifier: Apache-2.0
// A plain and a shaped move of the firmware in the emulator, and what the host makes of the same registers.
#pragma once

#include <string>

#include "sim/cli/chip.hpp"
#include "sim/cli/json_fwd.hpp"
#include "sim/cli/move_job.hpp"

namespace stillpoint::cli {

struct Hashes {
  uint64_t chip;
  uint64_t host;
  bool same() const { return chip == host; }
};

struct HilMoves {
  MoveJob job;  // rounded
  ChipRun plain;
  ChipRun shaped;
  sim::Comparison comparison;  // of what the chip emitted
  Hashes plain_hashes;
  Hashes shaped_hashes;
  bool same_bits() const { return plain_hashes.same() && shaped_hashes.same(); }
};

// `job` as `rounded` has it.
HilMoves run_on_chip_and_host(const MoveJob& job, const std::string& elf);
// The same; where the limits do not allow the shaped move its duration, in the least time.
HilMoves run_on_chip_within_or_least(const MoveJob& job, const std::string& elf);

Json json_of(const HilMoves& moves);
void print_moves(const HilMoves& moves);

// Says so on standard error where the bits are not the same.
int exit_code_of(const HilMoves& moves);

}  // namespace stillpoint::cli
