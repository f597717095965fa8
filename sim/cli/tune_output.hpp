// SPDX-License-Identifier: Apache-2.0
// How a tuning is shown.
#pragma once

#include <string>
#include <vector>

#include "sim/cli/identified.hpp"
#include "sim/cli/json_fwd.hpp"
#include "sim/cli/tune_options.hpp"

namespace stillpoint::cli {

// The specifications proposed, each number to the digit that the drive's registers hold (drive-map.md): what is printed
// is what is run.
std::vector<sim::SpecifiedShaper> proposed_shapers(const TuneProposal& proposal);

// The report in units for counts and in the sensor's unit for its raw steps.
TuneReport in_units(TuneReport report, const sim::TuneTask& task);
Announcement in_units(Announcement announced, const sim::TuneTask& task);

// "ok", or why nothing is kept: the finding, or "not_better" where the verification undid it.
std::string result_of(const TuneReport& report);
// Says so on standard error: 1.
int exit_code_of_failure(const TuneReport& report);

const char* sensor_unit(TuneSource source);

// What is printed is in these.
struct TuneUnits {
  const char* length;
  const char* following_error;
  const char* acceleration;
};
constexpr TuneUnits kUnits{"unit", "unit", "unit/s^2"};
constexpr TuneUnits kCounts{"counts", "counts", "raw steps"};  // as the drive has it

// All that is shown is in units.
Json json_of(const Announcement& announced);
// What is in the report: `identified`, `source`, `source_enough`, `excited_by`, `announced`, `flaws`, `predicted`,
// `verified`.
Json json_of(const TuneReport& report);
void print_report(const TuneReport& report, const TuneUnits& units = kUnits);
void print_proposal(const TuneReport& report, const std::vector<sim::SpecifiedShaper>& shapers,
                    const TuneUnits& units = kUnits);

// Bytes that the tuner has for itself, and those that it borrows from the axis.
Json json_of_memory();

// Every tick from the start to the last of the verification.
void write_tune_csv(const std::string& path, const std::string& command, const TuneJob& job,
                    const std::vector<sim::TuneTick>& ticks);

}  // namespace stillpoint::cli
