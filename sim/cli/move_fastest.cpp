// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/move_fastest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/cli/json.hpp"
#include "sim/cli/move_output.hpp"
#include "sim/cli/progress.hpp"
#include "sim/fastest.hpp"
#include "sim/least_ticks.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

using sim::bad_argument;

// The modes to design for: the shapers', where some are given, else the arm's.
std::vector<Mode> modes_of(const MoveJobOptions& options, const sim::ArmModes& arm) {
  std::vector<Mode> modes;
  if (!options.shaper.specs.empty()) {
    for (const sim::SpecifiedShaper& spec : specs_of(options.shaper)) {
      if (spec.kind != ShaperKind::kNone && spec.kind != ShaperKind::kCustom) modes.push_back(spec.mode);
    }
  }
  if (!modes.empty()) return modes;
  for (const sim::ArmMode& mode : arm) modes.push_back(mode.mode);
  return modes;
}

void refuse_durations(const MoveJobOptions& options) {
  const auto refuse = [](const char* option, const std::string& value) {
    throw bad_argument(option, value, "not with --fastest, which looks for the least; it is accepted without");
  };
  if (!options.move.duration.empty()) refuse("--duration", options.move.duration);
  if (options.zero_delay) refuse("--zero-delay", "given");
}

struct Answer {
  sim::FastestAnswer fastest;
  std::optional<uint32_t> least_ticks;
};

Answer answer_to(const sim::FastestQuestion& question, bool with_least) {
  Answer answer;
  {
    Progress progress("trying combinations");
    answer.fastest = sim::find_fastest(question, [&](double part) { progress.update(part); });
  }
  const sim::FastestCandidate& best = answer.fastest.candidates.front();
  if (!with_least || question.task.distance_counts == 0 || !best.still_ticks) return answer;
  Progress progress("linear programme");
  const sim::LeastTicksQuestion least{std::abs(static_cast<double>(question.task.distance_counts)),
                                      question.task.limits, question.modes, question.task.tick_s};
  // One that is still by the tolerance alone may be sooner than any that is quite still.
  const uint32_t known = answer.fastest.best.report.total_ticks + 1;
  for (uint32_t enough = known; enough <= sim::kMostLeastTicks && !answer.least_ticks; enough *= 2) {
    answer.least_ticks = sim::least_ticks(least, enough, [&](double part) { progress.update(part); });
  }
  return answer;
}

Json ticks_or_null(const std::optional<uint32_t>& ticks) { return ticks ? Json(*ticks) : Json(nullptr); }

Json candidate_json(const sim::FastestCandidate& candidate) {
  std::string shaper;
  for (const sim::SpecifiedShaper& spec : candidate.combination.shapers) {
    shaper += (shaper.empty() ? "" : "+") + sim::spec_text(spec);
  }
  return {{"name", candidate.name},
          {"shaper", shaper.empty() ? "none" : shaper},
          {"zero_delay", candidate.combination.zero_delay},
          {"timing", text(candidate.timing)},
          {"ticks", ticks_or_null(candidate.still_ticks)},
          {"move_ticks", candidate.move_ticks},
          {"residual_ratio", candidate.residual_ratio},
          {"peak_velocity", candidate.stream.peak_velocity},
          {"peak_acceleration", candidate.stream.peak_acceleration},
          {"peak_jerk", candidate.stream.peak_jerk},
          {"within_limits", candidate.stream.within_limits}};
}

Json json_of(const Answer& answer, const sim::Comparison& comparison) {
  const sim::FastestCandidate& best = answer.fastest.candidates.front();
  Json object = {{"result", comparison.within_limits ? "ok" : "limits_broken"}};
  object.update(cli::json_of(comparison));
  add_timing(object, comparison.shaped.report);
  object["fastest"] = best.name;
  object["ticks"] = ticks_or_null(best.still_ticks);
  if (answer.least_ticks) {
    object["least_ticks"] = *answer.least_ticks;
    object["ratio_to_least"] = static_cast<double>(best.still_ticks.value_or(0)) / *answer.least_ticks;
  }
  Json candidates = Json::array();
  for (const sim::FastestCandidate& each : answer.fastest.candidates) candidates.push_back(candidate_json(each));
  object["candidates"] = candidates;
  return object;
}

void print_answer(const Answer& answer, const sim::Comparison& comparison) {
  Table table({"combination", "still [ticks]", "moves [ticks]", "of plain", "timing", "peak v [unit/s]", "a [unit/s^2]",
               "j [unit/s^3]", "limits"});
  for (const sim::FastestCandidate& each : answer.fastest.candidates) {
    table.row({each.name, each.still_ticks ? std::to_string(*each.still_ticks) : "never",
               std::to_string(each.move_ticks), figure(each.residual_ratio), text(each.timing),
               figure(each.stream.peak_velocity), figure(each.stream.peak_acceleration), figure(each.stream.peak_jerk),
               each.stream.within_limits ? "held" : "BROKEN"});
  }
  table.print();
  fmt::print("\n");
  print_comparison(comparison);
  print_timing(comparison.shaped.report);
  const sim::FastestCandidate& best = answer.fastest.candidates.front();
  fmt::print("still soonest: {}\n", best.name);
  if (!answer.least_ticks) return;
  fmt::print("the least ticks that any command needs: {}, ratio {:.3f}\n", *answer.least_ticks,
             static_cast<double>(best.still_ticks.value_or(0)) / *answer.least_ticks);
}

}  // namespace

void add_fastest(CLI::App& app, FastestOptions& options) {
  add_flag(app, "--fastest", options.fastest,
           "the shaped move is the combination of profile and shaper that is still soonest within the limits");
  add_value(app, "--tolerance", options.tolerance, "R",
            "still, for --fastest: tip acceleration at most this part of the plain peak after the move (default 0.05)");
  add_flag(app, "--least-ticks", options.least_ticks,
           "with --fastest: also the least ticks that any command needs, by linear programming");
}

void refuse_fastest_alone(const FastestOptions& options) {
  if (options.least_ticks) throw bad_argument("--least-ticks", "given", "given alone, it is accepted with --fastest");
  if (options.tolerance.empty()) return;
  throw bad_argument("--tolerance", options.tolerance, "given alone, it is accepted with --fastest");
}

int run_fastest(const MoveJobOptions& options, const FastestOptions& fastest, const Output& output) {
  refuse_durations(options);
  MoveJobOptions without = options;
  if (without.shaper.specs.empty()) without.shaper.specs = {"none"};
  MoveJob job = job_of(without);
  sim::FastestQuestion question{job.plain, job.arm, modes_of(options, job.arm), kDefaultTolerance};
  if (!fastest.tolerance.empty()) {
    question.tolerance = sim::parse_within(fastest.tolerance, "--tolerance", kMinTolerance, kMaxTolerance);
  }
  Answer answer = answer_to(question, fastest.least_ticks);
  const sim::FastestCandidate& best = answer.fastest.candidates.front();
  job.shaped.profile = best.combination.profile;
  job.shaped.zero_delay = best.combination.zero_delay;
  job.specs = best.combination.shapers;
  job.design = answer.fastest.design;
  const sim::Comparison comparison =
      sim::compare(job.plain, std::move(answer.fastest.plain), job.shaped, std::move(answer.fastest.best), job.arm,
                   job.design.stage_count, job.settle_band);
  if (!output.csv.empty()) write_move_csv(output.csv, "move --fastest", job, comparison);
  if (!output.plot.empty()) draw(output.plot, picture_of("stillpoint move: " + best.name, job, comparison));
  if (output.json) {
    print_json(json_of(answer, comparison));
  } else {
    print_answer(answer, comparison);
  }
  return exit_code_of(comparison.within_limits);
}

}  // namespace stillpoint::cli
