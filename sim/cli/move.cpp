// SPDX-License-Identifier: Apache-2.0
// `stillpoint move`: a move plain and shaped, on the simulated arm.
#include <fmt/format.h>

#include <memory>

#include "sim/cli/command.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/move_fastest.hpp"
#include "sim/cli/move_job.hpp"
#include "sim/cli/move_output.hpp"

namespace stillpoint::cli {
namespace {

int run(const MoveJobOptions& options, const FastestOptions& fastest, const Output& output) {
  check_output(output);
  if (fastest.fastest) return run_fastest(options, fastest, output);
  refuse_fastest_alone(fastest);
  const MoveJob job = job_of(options);
  const sim::Comparison comparison = run_on_host(job);
  const bool within = comparison.within_limits;
  if (!output.csv.empty()) write_move_csv(output.csv, "move", job, comparison);
  if (!output.plot.empty()) draw(output.plot, picture_of("stillpoint move: plain against shaped", job, comparison));
  if (output.json) {
    Json object = {{"result", within ? "ok" : "limits_broken"}};
    object.update(json_of(comparison));
    add_timing(object, comparison.shaped.report);
    print_json(object);
  } else {
    print_comparison(comparison);
    print_timing(comparison.shaped.report);
  }
  return exit_code_of(within);
}

}  // namespace

void add_move(Commands& commands, Output& output) {
  const auto options = std::make_shared<MoveJobOptions>();
  const auto fastest = std::make_shared<FastestOptions>();
  CLI::App& app = commands.add("move", "Runs a move plain and shaped on the simulated arm.",
                               [options, fastest, &output] { return run(*options, *fastest, output); });
  add_move_job(app, *options);
  add_fastest(app, *fastest);
  add_output(app, output);
}

}  // namespace stillpoint::cli
