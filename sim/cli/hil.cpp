// SPDX-License-Identifier: Apache-2.0
// `stillpoint hil`: the firmware in the emulator, on the simulated arm, against the host.
#include <CLI/CLI.hpp>
#include <memory>
#include <vector>

#include "sim/cli/command.hpp"
#include "sim/cli/hil_moves.hpp"
#include "sim/cli/hil_tune.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/move_job.hpp"
#include "sim/cli/move_output.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

struct HilOptions {
  std::string elf;
  MoveJobOptions moves;
  bool tune = false;
  TuneOptions tuning;
  std::vector<const CLI::Option*> only_tuning;
};

// What goes with --tune only, and what does not.
void check_tune(const HilOptions& options) {
  if (options.tune && !options.moves.shaper.specs.empty()) {
    throw sim::bad_argument("--shaper", options.moves.shaper.specs[0],
                            "with --tune the drive finds its own, it is accepted without");
  }
  for (const CLI::Option* option : options.only_tuning) {
    if (options.tune || option->count() == 0) continue;
    throw sim::bad_argument(option->get_name(), option->results()[0], "given alone, it is accepted with --tune");
  }
}

int run_moves(const HilOptions& options, const Output& output) {
  const HilMoves moves = run_on_chip_and_host(rounded(job_of(options.moves)), options.elf);
  if (!output.csv.empty()) write_move_csv(output.csv, "hil", moves.job, moves.comparison);
  if (!output.plot.empty()) {
    draw(output.plot, picture_of("stillpoint hil: the firmware in the emulator", moves.job, moves.comparison));
  }
  if (output.json) {
    print_json(json_of(moves));
  } else {
    print_moves(moves);
  }
  return exit_code_of(moves);
}

int run(const HilOptions& options, const Output& output) {
  check_output(output);
  if (options.elf.empty()) {
    throw sim::bad_argument("--elf", "missing", "a firmware image is needed, `--elf FILE` is accepted");
  }
  check_tune(options);
  return options.tune ? run_hil_tune(options.moves, options.tuning, options.elf, output) : run_moves(options, output);
}

}  // namespace

void add_hil(Commands& commands, Output& output) {
  const auto options = std::make_shared<HilOptions>();
  CLI::App& app =
      commands.add("hil",
                   "Runs a move plain and shaped on the firmware in the emulator, and compares; with --tune "
                   "after it has found its shaper by itself.",
                   [options, &output] { return run(*options, output); });
  add_value(app, "--elf", options->elf, "FILE", "the firmware: build/stm32f405/stillpoint.elf");
  add_move_job(app, options->moves);
  add_flag(app, "--tune", options->tune, "the firmware finds the shaper by itself; with the options below");
  const size_t before = app.get_options().size();
  add_tune_options(app, options->tuning);
  const std::vector<CLI::Option*> all = app.get_options();
  options->only_tuning.assign(all.begin() + static_cast<std::ptrdiff_t>(before), all.end());
  add_output(app, output);
}

}  // namespace stillpoint::cli
