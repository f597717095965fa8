// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <utility>

#include "sim/cli/json.hpp"
#include "sim/cli/plot.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

std::string names(const std::vector<Command>& commands) {
  std::string all;
  for (const Command& command : commands) all += (all.empty() ? "" : " ") + command.app->get_name();
  return all;
}

std::string options_of(const CLI::App& app) {
  std::string all;
  for (const CLI::Option* option : app.get_options()) all += (all.empty() ? "" : " ") + option->get_name();
  return all;
}

// CLI11's messages begin with the option's name.
sim::Refusal refusal_of(const CLI::ParseError& error) {
  const std::string message = error.what();
  const size_t colon = message.find(':');
  const std::string option = message.compare(0, 2, "--") == 0 ? message.substr(0, colon) : "arguments";
  if (error.get_name() == "ArgumentMismatch") {
    return sim::bad_argument("option", option, "needs exactly one value, `" + option + " VALUE` is accepted");
  }
  return sim::bad_argument("option", option, "not understood (" + message + "), see --help for what is accepted");
}

int report(const sim::Refusal& refusal, bool json) {
  if (json && refusal.exit_code() == 1) print_json({{"result", refusal.result()}});
  std::fflush(stdout);
  std::fprintf(stderr, "stillpoint: error: %s\n", refusal.what());
  return refusal.exit_code();
}

}  // namespace

CLI::App& Commands::add(const std::string& name, const std::string& description, std::function<int()> run) {
  CLI::App* app = app_.add_subcommand(name, description);
  app->allow_extras();
  commands_.push_back({app, std::move(run)});
  return *app;
}

int Commands::dispatch() {
  const std::vector<std::string> strays = app_.remaining();
  for (const Command& command : commands_) {
    if (!command.app->parsed()) continue;
    const std::vector<std::string> extras = command.app->remaining();
    if (!extras.empty()) {
      throw sim::bad_argument(extras[0][0] == '-' ? "option" : "argument", extras[0],
                              "not known to `" + command.app->get_name() + "`, accepted: " + options_of(*command.app));
    }
    return command.run();
  }
  if (!strays.empty()) throw sim::bad_argument("command", strays[0], "not known, accepted: " + names(commands_));
  throw sim::bad_argument("command", "missing", "one is needed, accepted: " + names(commands_));
}

int Commands::main(int argc, char** argv, Output& output) {
  app_.allow_extras();
  // One command; a word after it that is another's name (`drive PORT move`) is its own business.
  app_.require_subcommand(0, 1);
  try {
    try {
      app_.parse(argc, argv);
    } catch (const CLI::Success& done) {  // --help, --version
      return app_.exit(done);
    } catch (const CLI::ParseError& error) {
      throw refusal_of(error);
    }
    const int code = dispatch();
    if (std::fflush(stdout) != 0)
      throw sim::bad_argument("standard output", "write", "failed, a file or pipe with room is accepted");
    return code;
  } catch (const sim::Refusal& refusal) {
    return report(refusal, output.json);
  } catch (const std::exception& error) {
    return report(sim::Refusal(sim::Refusal::Cause::kCannot, "internal", error.what(),
                               "this is a defect, please report it", "internal"),
                  output.json);
  }
}

CLI::Option* add_value(CLI::App& app, const std::string& name, std::string& value, const std::string& placeholder,
                       const std::string& help) {
  return app.add_option(name, value, help)->option_text(placeholder);
}

void add_required(CLI::App& app, const std::string& name, std::string& value, const std::string& placeholder,
                  const std::string& help) {
  add_value(app, name, value, placeholder, help)->required();
}

void add_values(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                const std::string& placeholder, const std::string& help) {
  app.add_option(name, values, help)
      ->option_text(placeholder)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_arguments(CLI::App& app, const std::string& name, std::vector<std::string>& values, const std::string& help) {
  app.add_option(name, values, help)->option_text(" ");
}

void add_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help) {
  app.add_flag(name, value, help);
}

void check_output(const Output& output) {
  check_picture(output.plot);
  const std::pair<const char*, const std::string&> files[] = {{"--csv", output.csv}, {"--plot", output.plot}};
  for (const auto& [option, path] : files) {
    if (path.empty()) continue;
    const bool there = std::filesystem::exists(path);
    std::FILE* file = std::fopen(path.c_str(), "a");
    if (file == nullptr) throw sim::bad_argument(option, path, "cannot be written, a file that can be is accepted");
    std::fclose(file);
    if (!there) std::filesystem::remove(path);
  }
}

int exit_code_of(bool within_limits) {
  if (within_limits) return 0;
  std::fprintf(stderr,
               "stillpoint: error: limits: broken: by the setpoints emitted, which is a defect, please report it\n");
  return 1;
}

void add_json(CLI::App& app, Output& output) {
  add_flag(app, "--json", output.json, "print one JSON object instead of a table");
}

void add_output(CLI::App& app, Output& output) {
  add_json(app, output);
  add_value(app, "--csv", output.csv, "FILE", "write the trace as CSV");
  add_value(app, "--plot", output.plot, "FILE", "draw it: FILE.svg or FILE.png (needs gnuplot)");
}

}  // namespace stillpoint::cli
