// SPDX-License-Identifier: Apache-2.0
// `stillpoint robustness`: the frequency error that each type of shaper forgives.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "shaper/shaping/peak.hpp"
#include "shaper/shaping/prototype.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/table.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

constexpr double kDampings[] = {0.0, 0.02, 0.1, 0.2};
constexpr double kHighestRatio = 10.0;  // the arm's frequency over the shaper's, as far as the edge is looked for

struct Forgiven {
  bool exists;
  double low_percent;
  double high_percent;  // infinite above kHighestRatio
  double length;        // periods of the undamped mode
};

Forgiven forgiven_by(ShaperKind kind, double damping_ratio, double tolerance) {
  const ShaperSpec spec{kind, {1.0, damping_ratio}, tolerance, kDefaultSpacing, nullptr};
  Prototype prototype;
  if (!make_prototype(spec, prototype).ok()) return {false, 0.0, 0.0, 0.0};
  constexpr double kStep = 1e-3;
  const double level = std::log(tolerance) + 1e-9;  // humps of the tolerance itself are tolerated
  const double low = edge_towards(prototype.train, damping_ratio, level, prototype.zeros[0].ratio, 0.0, kStep);
  const double highest_zero = prototype.zeros[prototype.zero_count - 1].ratio;
  const double high = edge_towards(prototype.train, damping_ratio, level, highest_zero, kHighestRatio, kStep);
  const double high_percent = high < kHighestRatio ? 100.0 * (high - 1.0) : HUGE_VAL;
  return {true, 100.0 * (low - 1.0), high_percent, prototype.train.length()};
}

std::vector<ShaperKind> kinds() {
  std::vector<ShaperKind> all;
  for (uint32_t i = 1; i < kShaperKinds; ++i) {
    if (static_cast<ShaperKind>(i) != ShaperKind::kCustom) all.push_back(static_cast<ShaperKind>(i));
  }
  return all;
}

std::string cell_of(const Forgiven& forgiven) {
  if (!forgiven.exists) return "no solution";
  if (std::isinf(forgiven.high_percent)) return fmt::format("{:.1f} / any", forgiven.low_percent);
  return fmt::format("{:.1f} / +{:.1f}", forgiven.low_percent, forgiven.high_percent);
}

void print_as_table(double tolerance) {
  std::vector<std::string> head = {"type", "length [periods]"};
  for (const double damping : kDampings) head.push_back("zeta " + sim::shortest(damping));
  Table table(head);
  for (const ShaperKind kind : kinds()) {
    std::vector<std::string> cells = {text(kind), fmt::format("{:.3f}", forgiven_by(kind, 0.0, tolerance).length)};
    for (const double damping : kDampings) cells.push_back(cell_of(forgiven_by(kind, damping, tolerance)));
    table.row(cells);
  }
  fmt::print("Error of the arm's frequency, in percent of the shaper's, that leaves at most {} % of the vibration\n\n",
             sim::shortest(100.0 * tolerance));
  table.print();
}

void print_as_json(double tolerance) {
  Json types = Json::array();
  for (const ShaperKind kind : kinds()) {
    Json rows = Json::array();
    for (const double damping : kDampings) {
      const Forgiven forgiven = forgiven_by(kind, damping, tolerance);
      Json row = {{"damping_ratio", damping}, {"exists", forgiven.exists}};
      if (forgiven.exists) {
        row["length_periods"] = forgiven.length;
        row["low_ratio"] = 1.0 + forgiven.low_percent / 100.0;
        row["high_ratio"] =
            std::isinf(forgiven.high_percent) ? Json(nullptr) : Json(1.0 + forgiven.high_percent / 100.0);
      }
      rows.push_back(row);
    }
    types.push_back({{"type", text(kind)}, {"dampings", rows}});
  }
  print_json({{"result", "ok"}, {"tolerance", tolerance}, {"types", types}});
}

int run(const std::string& tolerance_text, const Output& output) {
  const double tolerance = sim::parse_within(tolerance_text, "--tolerance", kMinTolerance, kMaxTolerance);
  if (output.json) {
    print_as_json(tolerance);
  } else {
    print_as_table(tolerance);
  }
  return 0;
}

}  // namespace

void add_robustness(Commands& commands, Output& output) {
  const auto tolerance = std::make_shared<std::string>("0.05");
  CLI::App& app = commands.add("robustness", "The error of the arm's frequency that each type of shaper forgives.",
                               [tolerance, &output] { return run(*tolerance, output); });
  add_value(app, "--tolerance", *tolerance, "V", "tolerated residual, and height of the humps (default 0.05)");
  add_json(app, output);
}

}  // namespace stillpoint::cli
