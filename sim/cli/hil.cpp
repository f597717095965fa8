// SPDX-License-Identifier: Apache-2.0
// `stillpoint hil`: the firmware in the emulator, on the simulated arm, against the host.
#include <memory>

#include "sim/cli/command.hpp"
#include "sim/cli/hil_moves.hpp"
#include "sim/cli/move_job.hpp"
#include "sim/cli/move_output.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

int run(const MoveJobOptions& options, const std::string& elf, const Output& output) {
  check_output(output);
  if (elf.empty()) throw sim::bad_argument("--elf", "missing", "a firmware image is needed, `--elf FILE` is accepted");
  const HilMoves moves = run_on_chip_and_host(rounded(job_of(options)), elf);
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

}  // namespace

void add_hil(Commands& commands, Output& output) {
  const auto options = std::make_shared<MoveJobOptions>();
  const auto elf = std::make_shared<std::string>();
  CLI::App& app = commands.add("hil", "Runs a move plain and shaped on the firmware in the emulator, and compares.",
                               [options, elf, &output] { return run(*options, *elf, output); });
  add_value(app, "--elf", *elf, "FILE", "the firmware: build/stm32f405/stillpoint.elf");
  add_move_job(app, *options);
  add_output(app, output);
}

}  // namespace stillpoint::cli
