// SPDX-License-Identifier: Apache-2.0
// Options that several commands share, as typed and as meant.
#pragma once

#include <string>
#include <vector>

#include "sim/cli/command.hpp"
#include "sim/cli/csv.hpp"
#include "sim/experiment.hpp"
#include "sim/spec.hpp"

namespace stillpoint::cli {

struct TickOption {
  std::string tick = "0.001";
};
void add_tick(CLI::App& app, TickOption& option);
double tick_of(const TickOption& option);

struct ShaperOption {
  std::vector<std::string> specs;
};
void add_shaper(CLI::App& app, ShaperOption& option);
// All of them, in order. Refuses none at all (`--shaper none` says that none is wanted).
std::vector<sim::SpecifiedShaper> specs_of(const ShaperOption& option);

struct LimitOptions {
  std::string velocity;
  std::string acceleration;
  std::string deceleration;
  std::string jerk;
  std::string deceleration_jerk;
  std::string counts_per_unit = "1000000";

  bool given() const { return !(velocity + acceleration + deceleration + jerk + deceleration_jerk).empty(); }
};
void add_limits(CLI::App& app, LimitOptions& options);
// In counts; all of them are needed, but for those of the deceleration. Refuses by the option's name.
AxisLimits limits_of(const LimitOptions& options);

// What `profile` knows of a move.
struct MoveOptions : LimitOptions {
  TickOption tick;
  std::string distance;
  std::string kind;
  std::string duration;
};
void add_move_options(CLI::App& app, MoveOptions& options);
// In counts. Refuses by the option's name.
sim::MoveTask task_of(const MoveOptions& options);

// The task in units, for the head of a CSV file.
Settings settings_of(const sim::MoveTask& task);

}  // namespace stillpoint::cli
