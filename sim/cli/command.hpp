// SPDX-License-Identifier: Apache-2.0
// What a command is: a CLI11 subcommand and what to do once all arguments are known to be understood.
#pragma once

#include <functional>
#include <string>
#include <vector>

// Reading CLI11 takes a compiler seconds; what adds its options by the functions below need not.
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace stillpoint::cli {

// Where results go, for every command.
struct Output {
  bool json = false;
  std::string csv;
  std::string plot;
};

struct Command {
  CLI::App* app;
  std::function<int()> run;  // returns the exit code; throws sim::Refusal
};

class Commands {
 public:
  explicit Commands(CLI::App& app) : app_(app) {}

  CLI::App& add(const std::string& name, const std::string& description, std::function<int()> run);

  // Parses, runs, and turns every refusal into its one line and exit code.
  int main(int argc, char** argv, Output& output);

 private:
  int dispatch();

  CLI::App& app_;
  std::vector<Command> commands_;
};

// --NAME VALUE as text: turned into a number by options.hpp, whose refusals say what would be accepted.
// Without dashes in NAME it is an argument.
CLI::Option* add_value(CLI::App& app, const std::string& name, std::string& value, const std::string& placeholder,
                       const std::string& help);
// The same, cannot be left out.
void add_required(CLI::App& app, const std::string& name, std::string& value, const std::string& placeholder,
                  const std::string& help);
// The same, may be repeated.
void add_values(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                const std::string& placeholder, const std::string& help);
// All arguments that are left.
void add_arguments(CLI::App& app, const std::string& name, std::vector<std::string>& values, const std::string& help);
void add_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help);
void add_output(CLI::App& app, Output& output);
void add_json(CLI::App& app, Output& output);

// Refuses, before any work is done, files that cannot be written and pictures that cannot be drawn.
void check_output(const Output& output);

// The exit code of a command whose setpoints keep their limits or not; says so on standard error when not.
int exit_code_of(bool within_limits);

// One a file.
void add_design(Commands& commands, Output& output);
void add_hardware_limits(Commands& commands, Output& output);
void add_profile(Commands& commands, Output& output);
void add_sensitivity(Commands& commands, Output& output);
void add_robustness(Commands& commands, Output& output);
void add_recommend(Commands& commands, Output& output);
void add_group(Commands& commands, Output& output);
void add_identify(Commands& commands, Output& output);
void add_shape(Commands& commands);
void add_move(Commands& commands, Output& output);
void add_tune(Commands& commands, Output& output);
void add_hil(Commands& commands, Output& output);
void add_drive(Commands& commands, Output& output);
void add_emulate(Commands& commands);
void add_scope(Commands& commands, Output& output);
void add_registers(Commands& commands, Output& output);
void add_demo(Commands& commands, Output& output);
void add_park(Commands& commands, Output& output);
void add_table(Commands& commands, Output& output);

}  // namespace stillpoint::cli
