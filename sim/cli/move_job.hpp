// SPDX-License-Identifier: Apache-2.0
// A plain and a shaped move on one arm: what `move`, `hil` and `demo` have in common.
#pragma once

#include <string>
#include <vector>

#include "sim/cli/options.hpp"
#include "sim/evaluation.hpp"
#include "sim/plant/arm.hpp"
#include "sim/spec.hpp"

namespace stillpoint::cli {

struct MoveJobOptions {
  MoveOptions move;
  ShaperOption shaper;
  std::string arm;
  std::string settle_band = "0.2";
  bool zero_delay = false;
  std::string shaped_duration;
};
void add_move_job(CLI::App& app, MoveJobOptions& options);
// All but --shaper and --zero-delay.
void add_move_job_without_shaper(CLI::App& app, MoveJobOptions& options);

struct MoveJob {
  sim::MoveTask plain;
  sim::MoveTask shaped;
  std::vector<sim::SpecifiedShaper> specs;
  ShaperDesign design;
  sim::ArmModes arm;
  double settle_band;
};
MoveJob job_of(const MoveJobOptions& options);
MoveJob job_without_shaper(const MoveJobOptions& options);
void set_shapers(const std::vector<sim::SpecifiedShaper>& specs, MoveJob& job);

// Both moves through an axis on the host.
sim::Comparison run_on_host(const MoveJob& job);
// The same; where the limits do not allow the shaped move its duration, in the least time, and `job` says so.
sim::Comparison run_within_or_least(MoveJob& job);

}  // namespace stillpoint::cli
