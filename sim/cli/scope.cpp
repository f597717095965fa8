// SPDX-License-Identifier: Apache-2.0
// `stillpoint scope`: draws what `drive PORT scope` has captured.
#include <memory>

#include "sim/cli/command.hpp"
#include "sim/cli/scope_record.hpp"

namespace stillpoint::cli {
namespace {

struct ScopeOptions {
  std::string file;
};

int run(const ScopeOptions& options, const Output& output) {
  check_output(output);
  const ScopeRecord record = read_scope_csv(options.file);
  if (!output.csv.empty()) write_scope_csv(output.csv, {{"file", options.file}}, record);
  if (!output.plot.empty()) draw_scope(output.plot, "stillpoint scope " + options.file, record);
  if (output.json) {
    print_json(json_of(record));
  } else {
    print_scope(record);
  }
  return 0;
}

}  // namespace

void add_scope(Commands& commands, Output& output) {
  const auto options = std::make_shared<ScopeOptions>();
  CLI::App& app = commands.add("scope", "Draws what `drive PORT scope` has captured.",
                               [options, &output] { return run(*options, output); });
  add_required(app, "file", options->file, "FILE", "CSV: a time in s, then a column a channel");
  add_output(app, output);
}

}  // namespace stillpoint::cli
