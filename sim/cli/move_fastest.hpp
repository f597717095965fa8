// SPDX-License-Identifier: Apache-2.0
// `stillpoint move --fastest`: among profiles and shapers the combination that is still soonest.
#pragma once

#include <string>

#include "sim/cli/command.hpp"
#include "sim/cli/move_job.hpp"

namespace stillpoint::cli {

struct FastestOptions {
  bool fastest = false;
  bool least_ticks = false;
  std::string tolerance;
};
void add_fastest(CLI::App& app, FastestOptions& options);

// Refuses what goes with --fastest only.
void refuse_fastest_alone(const FastestOptions& options);

int run_fastest(const MoveJobOptions& options, const FastestOptions& fastest, const Output& output);

}  // namespace stillpoint::cli
