// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/tune_output.hpp"

#include <fmt/format.h>

#include <cmath>

#include "firmware/default_axis.hpp"
#include "sim/cli/csv.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/cli/table.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
std::vector<sim::SpecifiedShaper> proposed_shapers(const TuneProposal& proposal) {
  std::vector<sim::SpecifiedShaper> specs = sim::specified(proposal.specs, proposal.spec_count);
  for (sim::SpecifiedShaper& spec : specs) round_to_registers(spec);
  return specs;
}

std::string result_of(const TuneReport& report) {
  if (report.state == TuneState::kKept) return "ok";
  return report.identification.finding == Finding::kFound ? "not_better" : text(report.identification.finding);
}

int exit_code_of_failure(const TuneReport& report) {
  const bool found = report.identification.finding == Finding::kFound;
  std::fflush(stdout);
  fmt::print(stderr, "stillpoint: error: tune: {}: {}\n", result_of(report),
             found ? "the shaped move leaves no less than the plain one, an arm that does not change is accepted"
                   : why(report.identification.finding));
  return 1;
}

namespace {

const char* sensor_unit(TuneSource source, const TuneUnits& units) {
  return source == TuneSource::kFollowingError ? units.following_error : units.acceleration;
}

}  // namespace

const char* sensor_unit(TuneSource source) { return sensor_unit(source, kUnits); }

Announcement in_units(Announcement announced, const sim::TuneTask& task) {
  const double unit = task.move.counts_per_unit;
  return {announced.travel / unit, announced.velocity / unit, announced.acceleration / unit, announced.jerk / unit,
          announced.duration_s};
}

TuneReport in_units(TuneReport report, const sim::TuneTask& task) {
  const double sensor = unit_of(report.source, task);
  report.announced = in_units(report.announced, task);
  report.identification = scaled(IdentifiedRecord{{}, 1.0, 0.0, report.identification}, sensor).found;
  report.plain_ringing *= sensor;
  report.shaped_ringing *= sensor;
  return report;
}

Json json_of(const Announcement& announced) {
  return {{"travel", announced.travel},
          {"velocity", announced.velocity},
          {"acceleration", announced.acceleration},
          {"jerk", announced.jerk},
          {"duration_s", announced.duration_s}};
}

Json json_of(const TuneReport& report) {
  return {{"identified", json_of(report.identification)},
          {"source", sim::text(report.source)},
          {"source_enough", report.source_enough},
          {"excited_by", sim::text(report.excited_by)},
          {"announced", json_of(report.announced)},
          {"flaws",
           {{"gaps", report.flaws.gaps}, {"saturated", report.flaws.saturated}, {"overruns", report.flaws.overruns}}},
          {"predicted",
           {{"residual", report.proposal.residual},
            {"delay_s", report.proposal.delay_s},
            {"length_s", report.proposal.length_s}}},
          {"verified", {{"plain_ringing", report.plain_ringing}, {"shaped_ringing", report.shaped_ringing}}}};
}

void print_report(const TuneReport& report, const TuneUnits& units) {
  const Announcement& told = report.announced;
  fmt::print("excited by {}: ", sim::text(report.excited_by));
  fmt::print("at most {1} {0} either way, {2} {0}/s, {3} {0}/s^2, for {4} s\n", units.length, figure(told.travel),
             figure(told.velocity), figure(told.acceleration), figure(told.duration_s));
  fmt::print("listened to: {} [{}]; identified: {}\n\n", sim::text(report.source), sensor_unit(report.source, units),
             text(report.identification.finding));
  print_modes(report.identification);
}

void print_proposal(const TuneReport& report, const std::vector<sim::SpecifiedShaper>& shapers,
                    const TuneUnits& units) {
  if (shapers.empty()) return;
  fmt::print("\nshaper: {}\npredicted: residual at most {:.2f} %, delay {} s\n", sim::spec_text(shapers),
             100.0 * report.proposal.residual, figure(report.proposal.delay_s));
  fmt::print("verified: ringing {} {} rms after the plain move, {} after the shaped one\n\n",
             figure(report.plain_ringing), sensor_unit(report.source, units), figure(report.shaped_ringing));
}

Json json_of_memory() {
  return {{"own", sizeof(TuneMemory) + sizeof(AutoTune)}, {"borrowed", firmware::kLineCapacity * sizeof(double)}};
}

void write_tune_csv(const std::string& path, const std::string& command, const TuneJob& job,
                    const std::vector<sim::TuneTick>& ticks) {
  Settings settings = settings_of(job);
  settings.emplace_back("state", "1 exciting, 2 capturing, 3 identifying, 4 proposed, 5 applying, 6 verifying");
  CsvFile csv(path, command, settings,
              {"tick", "time_s", "state", "setpoint_counts", "setpoint", "arm", "arm_acceleration", "accelerometer",
               "following_error_counts"});
  const sim::TuneTask& task = job.task;
  const double unit = task.move.counts_per_unit * static_cast<double>(kSignalPerCount);
  for (size_t i = 0; i < ticks.size(); ++i) {
    const sim::TuneTick& tick = ticks[i];
    csv.row({std::to_string(i), sim::shortest(static_cast<double>(i) * task.move.tick_s),
             std::to_string(static_cast<int>(tick.state)), sim::exact_counts(tick.setpoint),
             sim::shortest(static_cast<double>(tick.setpoint) / unit), sim::shortest(tick.tip),
             sim::shortest(tick.tip_acceleration),
             sim::shortest(tick.acceleration * task.drive.accelerometer.resolution),
             sim::exact_counts(tick.setpoint - tick.position)});
  }
  csv.close();
}

}  // namespace stillpoint::cli
