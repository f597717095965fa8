// SPDX-License-Identifier: Apache-2.0
// `stillpoint hil --tune`: the firmware in the emulator finds its shaper by itself.
#pragma once

#include <string>

#include "sim/cli/command.hpp"
#include "sim/cli/move_job.hpp"
#include "sim/cli/tune_options.hpp"

namespace stillpoint::cli {

int run_hil_tune(const MoveJobOptions& moves, const TuneOptions& options, const std::string& elf, const Output& output);

}  // namespace stillpoint::cli
