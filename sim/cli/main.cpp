// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "sim/cli/command.hpp"

int main(int argc, char** argv) {
  CLI::App app("Motion that arrives and is still: profile and input shaping for servo drives.", "stillpoint");
  app.set_version_flag("--version", "stillpoint " STILLPOINT_VERSION);
  app.footer("Each command has its own --help. SI units; `unit` is your own unit of position.");
  stillpoint::cli::Commands commands(app);
  stillpoint::cli::Output output;
  stillpoint::cli::add_design(commands, output);
  stillpoint::cli::add_hardware_limits(commands, output);
  stillpoint::cli::add_profile(commands, output);
  stillpoint::cli::add_sensitivity(commands, output);
  stillpoint::cli::add_robustness(commands, output);
  stillpoint::cli::add_recommend(commands, output);
  stillpoint::cli::add_group(commands, output);
  stillpoint::cli::add_identify(commands, output);
  stillpoint::cli::add_shape(commands);
  stillpoint::cli::add_move(commands, output);
  stillpoint::cli::add_tune(commands, output);
  stillpoint::cli::add_hil(commands, output);
  stillpoint::cli::add_drive(commands, output);
  stillpoint::cli::add_emulate(commands);
  stillpoint::cli::add_scope(commands, output);
  stillpoint::cli::add_registers(commands, output);
  stillpoint::cli::add_demo(commands, output);
  stillpoint::cli::add_park(commands, output);
  stillpoint::cli::add_table(commands, output);
  return commands.main(argc, argv, output);
}
