// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/hil_tune.hpp"

#include <fmt/format.h>

#include "sim/cli/chip_tune.hpp"
#include "sim/cli/hil_moves.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/move_output.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/cli/tune_output.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

struct Result {
  TuneJob job;
  ChipTuning tuning;
  HilMoves moves;  // once a shaper is kept
};

// Of everything that the test image ran, null for the production image, which says nothing of it.
template <typename Count>
Json optional_count(const std::optional<Count>& count) {
  return count ? Json(*count) : Json(nullptr);
}

void add_costs(const Result& result, Json& object) {
  const ChipTuning& tuning = result.tuning;
  object["late_ticks"] = tuning.late_ticks
                             ? Json(*tuning.late_ticks + result.moves.plain.late_ticks + result.moves.shaped.late_ticks)
                             : Json(nullptr);
  object["missing_ticks"] = tuning.missing_ticks;
  object["instructions"] = optional_count(tuning.instructions);
  object["tuned_ticks"] = tuning.ticks.size();
  object["memory_bytes"] = json_of_memory();
}

Json json_of_result(const Result& result) {
  const ChipTuning& tuning = result.tuning;
  Json object = {{"result", result_of(tuning.report)}};
  object.update(json_of(tuning.report));
  object["first_announced"] = json_of(tuning.first_announced);
  if (tuning.report.state == TuneState::kKept) {
    object["shaper"] = sim::spec_text(tuning.shapers);
    object.update(json_of(result.moves));
  }
  add_costs(result, object);
  return object;
}

void print_costs(const ChipTuning& tuning) {
  const Json memory = json_of_memory();
  fmt::print("memory: {} bytes of the tuner's own, {} lent by the axis\n", memory["own"].dump(),
             memory["borrowed"].dump());
  fmt::print("{} ticks, {} missing to the drive", tuning.ticks.size(), tuning.missing_ticks);
  if (tuning.late_ticks) {
    fmt::print(", {} late; {:.1f} million instructions to identify and design, the ticks' own among them",
               *tuning.late_ticks, 1e-6 * static_cast<double>(*tuning.instructions));
  }
  fmt::print("\n\n");
}

void print_as_table(const Result& result) {
  const ChipTuning& tuning = result.tuning;
  print_report(tuning.report);
  print_proposal(tuning.report, tuning.shapers);
  print_costs(tuning);
  if (tuning.report.state == TuneState::kKept) print_moves(result.moves);
}

}  // namespace

int run_hil_tune(const MoveJobOptions& moves, const TuneOptions& options, const std::string& elf,
                 const Output& output) {
  Result result{job_of(moves, options), {}, {}};
  {
    Progress progress("tuning on the chip");
    result.tuning = tune_on_chip(elf, result.job, progress);
  }
  const bool kept = result.tuning.report.state == TuneState::kKept;
  if (kept) {
    set_shapers(result.tuning.shapers, result.job.moves);
    result.moves = run_on_chip_within_or_least(rounded(result.job.moves), elf);
  }
  if (!output.csv.empty()) write_tune_csv(output.csv, "hil --tune", result.job, result.tuning.ticks);
  if (kept && !output.plot.empty()) {
    draw(output.plot,
         picture_of("stillpoint hil --tune: the firmware in the emulator", result.moves.job, result.moves.comparison));
  }
  if (output.json) {
    print_json(json_of_result(result));
  } else {
    print_as_table(result);
  }
  return kept ? exit_code_of(result.moves) : exit_code_of_failure(result.tuning.report);
}

}  // namespace stillpoint::cli
