// SPDX-License-Identifier: Apache-2.0
// `stillpoint drive PORT tune`: the drive's own auto-tune, started, watched and ended from here; or the host's.
#pragma once

#include <string>

#include "sim/cli/command.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

// Counts and seconds. What is empty stays as the drive has it.
struct DriveTuneOptions {
  std::string excitation;
  std::string source;
  std::string amplitude;
  std::string travel;
  std::string band;
  std::string tolerance;
  bool propose = false;  // end where a shaper is proposed, and keep nothing
  std::string by;        // "drive", "host", or empty: the host where the drive cannot
};
void add_drive_tune_options(CLI::App& app, DriveTuneOptions& options);

// Enables the drive, tunes by its profile in force. Interrupted, it aborts the tuning, and from the host halts the axis
// and puts the shaper of before back, before it throws. The exit code.
int tune_drive(sim::RegisterPort& port, const DriveTuneOptions& options, const Output& output);

}  // namespace stillpoint::cli
