// SPDX-License-Identifier: Apache-2.0
// `stillpoint tune`: from an unknown arm to a still one, on the simulated drive.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "sim/cli/command.hpp"
#include "sim/cli/identified.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/move_output.hpp"
#include "sim/cli/progress.hpp"
#include "sim/cli/tune_options.hpp"
#include "sim/cli/tune_output.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct Result {
  TuneJob job;
  sim::Tuning tuning;
  sim::Comparison comparison;  // once a shaper is kept
};

sim::Tuning run_tuning(const TuneJob& job) {
  Progress progress("tuning on the host");
  sim::Tuning tuning = sim::tune_on_drive(job.task, [&](double part) { progress.update(part); });
  // What only the axis could know it could not do; what is wrong with an argument has been refused before.
  if (!tuning.report.refusal.ok()) sim::require(tuning.report.refusal, job.task.move.counts_per_unit);
  return tuning;
}

// Of the record, until its slowest decay has left e^-6; the fit that lies over noise tells nothing.
double shown_s(const IdentifiedRecord& record) {
  const double whole = static_cast<double>(record.samples.size()) / record.rate_hz;
  double shown = 0.0;
  for (size_t i = 0; i < record.found.mode_count; ++i) {
    const IdentifiedMode& mode = record.found.mode[i];
    const double decay = 2.0 * M_PI * mode.frequency_hz * mode.damping_ratio;
    shown = std::max(shown, decay * whole > 6.0 ? 6.0 / decay : whole);
  }
  return shown == 0.0 ? whole : shown;
}

Picture picture_of_tuning(const Result& result) {
  const sim::Tuning& tuning = result.tuning;
  const double unit = unit_of(tuning.report.source, result.job.task);
  const IdentifiedRecord record =
      scaled({tuning.record, tuning.record_rate_hz, tuning.record_begins_s, tuning.report.identification}, unit);
  Picture picture{"stillpoint tune", {}};
  if (!record.samples.empty()) {
    picture.panels = {record_panel(record, std::string("Record and fit, ") + sim::text(tuning.report.source),
                                   sensor_unit(tuning.report.source)),
                      spectrum_panel(record)};
    picture.panels[0].x_range = {{record.first_s, record.first_s + shown_s(record)}};
  }
  if (tuning.report.state != TuneState::kKept) return picture;
  const Picture moves = picture_of("", result.job.moves, result.comparison);
  picture.panels.insert(picture.panels.end(), moves.panels.begin(), moves.panels.end());
  return picture;
}

Json json_of_result(const Result& result) {
  const TuneReport& report = result.tuning.report;
  Json object = {{"result", result_of(report)}};
  object.update(json_of(in_units(report, result.job.task)));
  object["first_announced"] = json_of(in_units(result.tuning.first_announced, result.job.task));
  object["tuned_s"] = static_cast<double>(result.tuning.ticks.size()) * result.job.task.move.tick_s;
  object["memory_bytes"] = json_of_memory();
  if (report.state != TuneState::kKept) return object;
  object["shaper"] = sim::spec_text(result.job.moves.specs);
  object.update(json_of(result.comparison));
  add_timing(object, result.comparison.shaped.report);
  return object;
}

void print_as_table(const Result& result) {
  const TuneReport report = in_units(result.tuning.report, result.job.task);
  print_report(report);
  print_proposal(report, proposed_shapers(report.proposal));
  if (result.tuning.report.state != TuneState::kKept) return;
  print_comparison(result.comparison);
  print_timing(result.comparison.shaped.report);
}

int run(const MoveJobOptions& moves, const TuneOptions& options, const Output& output) {
  check_output(output);
  Result result{job_of(moves, options), {}, {}};
  result.tuning = run_tuning(result.job);
  const TuneReport& report = result.tuning.report;
  const bool kept = report.state == TuneState::kKept;
  if (kept) {
    set_shapers(proposed_shapers(report.proposal), result.job.moves);
    result.comparison = run_within_or_least(result.job.moves);
  }
  if (!output.csv.empty()) write_tune_csv(output.csv, "tune", result.job, result.tuning.ticks);
  if (!output.plot.empty()) draw(output.plot, picture_of_tuning(result));
  if (output.json) {
    print_json(json_of_result(result));
  } else {
    print_as_table(result);
  }
  return kept ? exit_code_of(result.comparison.within_limits) : exit_code_of_failure(report);
}

}  // namespace

void add_tune(Commands& commands, Output& output) {
  const auto moves = std::make_shared<MoveJobOptions>();
  const auto options = std::make_shared<TuneOptions>();
  CLI::App& app =
      commands.add("tune", "Lets the axis find its arm's modes and its shaper by itself, then moves plain and shaped.",
                   [moves, options, &output] { return run(*moves, *options, output); });
  add_move_job_without_shaper(app, *moves);
  add_flag(app, "--zero-delay", moves->zero_delay, "as in move; here the shaped move has it with and without");
  add_tune_options(app, *options);
  add_output(app, output);
}

}  // namespace stillpoint::cli
