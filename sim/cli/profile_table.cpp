// SPDX-License-Identifier: Apache-2.0
// `stillpoint table`: a profile table from a CSV or from another kind of profile.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>

#include "sim/cli/command.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/options.hpp"
#include "sim/cli/table.hpp"
#include "sim/refusal.hpp"
#include "sim/table_fit.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct TableOptions {
  MoveOptions move;
  std::string from;
  std::string order = "3";
  std::string spans = "16";
  std::string out;
  std::string header;
  std::string name = "kProfileTable";
};

struct Result {
  std::string source;
  size_t samples;
  sim::TableFit fit;
};

constexpr size_t kSamplesASpan = 64;
constexpr size_t kLeastSamples = 4096;

// Of the shapes that no limit changes, limits need not be given.
MoveOptions with_limits(MoveOptions options) {
  const ProfileKind kind = sim::parse_profile(options.kind).kind;
  if (kind != ProfileKind::kPoly5 && kind != ProfileKind::kPoly7 && kind != ProfileKind::kTable) return options;
  for (std::string* text : {&options.distance, &options.velocity, &options.acceleration, &options.jerk}) {
    if (text->empty()) *text = "1";
  }
  return options;
}

sim::ShapeSamples samples_of(const TableOptions& options, size_t spans, std::string& source) {
  if (!options.from.empty() && !options.move.kind.empty())
    throw sim::bad_argument("--from", options.from, "given with --kind, one of the two is accepted");
  if (!options.from.empty()) {
    source = options.from;
    return sim::read_shape(options.from);
  }
  if (options.move.kind.empty())
    throw sim::bad_argument("--from", "missing", "a source is needed, `--from FILE.csv` or `--kind KIND` is accepted");
  const sim::MoveTask task = task_of(with_limits(options.move));
  source = profile_text(task.profile);
  if (task.distance_counts == 0)
    throw sim::bad_argument("--distance", options.move.distance, "no move, another distance than 0 is accepted");
  return sim::sample_shape(task, std::max(spans * kSamplesASpan, kLeastSamples));
}

void check_name(const std::string& name) {
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  if (!name.empty() && std::all_of(name.begin(), name.end(), word) &&
      std::isdigit(static_cast<unsigned char>(name[0])) == 0)
    return;
  throw sim::bad_argument("--name", name, "not a name in C++, letters, digits and _ are accepted");
}

Result fitted(const TableOptions& options) {
  const auto order = static_cast<uint32_t>(sim::parse_integer(options.order, "--order", 1, kMaxTableOrder));
  const auto spans = static_cast<uint32_t>(sim::parse_integer(options.spans, "--spans", 1, 4096));
  check_name(options.name);
  Result result{};
  const sim::ShapeSamples samples = samples_of(options, spans, result.source);
  result.samples = samples.size();
  result.fit = sim::fit_table(samples, order, spans);
  return result;
}

void print_as_json(const Result& result) {
  const sim::TableData& data = result.fit.data;
  print_json({{"result", "ok"},
              {"source", result.source},
              {"samples", result.samples},
              {"order", data.order},
              {"spans", data.spans},
              {"flash_bytes", data.nodes.size() * sizeof(int64_t)},
              {"largest_deviation", result.fit.largest_deviation},
              {"peak_velocity", data.peaks.velocity},
              {"peak_acceleration", data.peaks.acceleration},
              {"peak_deceleration", data.peaks.deceleration},
              {"peak_jerk", data.peaks.jerk}});
}

void print_as_table(const Result& result) {
  const sim::TableData& data = result.fit.data;
  fmt::print("{}: order {}, {} spans, {} bytes of flash\n", result.source, data.order, data.spans,
             data.nodes.size() * sizeof(int64_t));
  fmt::print("largest deviation from {} samples: {} of the distance\n\n", result.samples,
             figure(result.fit.largest_deviation));
  Table peaks({"of a move of 1 in a time of 1", "peak"});
  peaks.row({"velocity", figure(data.peaks.velocity)});
  peaks.row({"acceleration", figure(data.peaks.acceleration)});
  peaks.row({"deceleration", figure(data.peaks.deceleration)});
  peaks.row({data.order > 1 ? "jerk" : "jerk between the knots, at which it has no limit", figure(data.peaks.jerk)});
  peaks.print();
}

int run(const TableOptions& options, const Output& output) {
  const Result result = fitted(options);
  const std::vector<std::string> comments = {
      "Written by `stillpoint table` from " + result.source,
      "largest deviation " + sim::shortest(result.fit.largest_deviation) + " of the distance"};
  if (!options.out.empty()) sim::write_table(options.out, result.fit.data, comments);
  if (!options.header.empty()) sim::write_table_header(options.header, result.fit.data, options.name, comments);
  if (output.json) {
    print_as_json(result);
  } else {
    print_as_table(result);
  }
  return 0;
}

}  // namespace

void add_table(Commands& commands, Output& output) {
  const auto options = std::make_shared<TableOptions>();
  CLI::App& app = commands.add("table", "Makes a profile table from a CSV or from another kind of profile.",
                               [options, &output] { return run(*options, output); });
  add_value(app, "--from", options->from, "FILE.csv",
            "samples of the move: columns time_s and position, or the first two, or positions alone at equal times");
  add_value(app, "--order", options->order, "N", "continuous derivatives: 1, 2 or 3 (default 3)");
  add_value(app, "--spans", options->spans, "N", "spans between knots, 1 to 4096 (default 16)");
  add_value(app, "--out", options->out, "FILE", "the table as text, for --kind table:FILE");
  add_value(app, "--header", options->header, "FILE.hpp", "the table as constexpr C++, for flash");
  add_value(app, "--name", options->name, "NAME", "its name there (default kProfileTable)");
  add_move_options(app, options->move);
  add_json(app, output);
}

}  // namespace stillpoint::cli
