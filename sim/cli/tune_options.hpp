// SPDX-License-Identifier: Apache-2.0
// What `tune` and `hil --tune` know beside the move.
#pragma once

#include <string>
#include <utility>

#include "sim/cli/csv.hpp"
#include "sim/cli/move_job.hpp"
#include "sim/tuning.hpp"

namespace stillpoint::cli {

struct TuneOptions {
  std::string excitation = "auto";
  std::string source = "auto";
  std::string amplitude;
  std::string travel;
  std::string band;
  std::string tolerance = "0.05";
  std::string noise = "0.03";
  std::string range = "1e6";
  std::string resolution = "0.001";
  std::string encoder_noise = "0";
  std::string reaction = "0";
  std::string seed = "1";
};
void add_tune_options(CLI::App& app, TuneOptions& options);

// By the words for them. Each refuses by the option's name.
TuneExcitation excitation_of(const std::string& text);
TuneSource source_of(const std::string& text);
// LO:HI in Hz, with LO below HI, up to `most`.
std::pair<double, double> band_of(const std::string& text, double most);

struct TuneJob {
  MoveJob moves;  // the shaped one with zero delay; without a shaper until one is found
  sim::TuneTask task;
};
// Refuses by the option's name.
TuneJob job_of(const MoveJobOptions& moves, const TuneOptions& options);

// A sensor's raw reading in its unit: unit/s^2, or for the following error units.
double unit_of(TuneSource source, const sim::TuneTask& task);

Settings settings_of(const TuneJob& job);

}  // namespace stillpoint::cli
