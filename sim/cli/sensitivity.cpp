// SPDX-License-Identifier: Apache-2.0
// `stillpoint sensitivity`: what shapers leave of vibrations that they were not designed for.
#include <fmt/format.h>

#include <memory>

#include "sim/analysis.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/csv.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/options.hpp"
#include "sim/cli/plot.hpp"
#include "sim/cli/table.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct SensitivityOptions {
  ShaperOption shaper;
  TickOption tick;
  std::string from;
  std::string to;
  std::string points = "200";
  std::string damping;
};

// One --shaper: a shaper, or several convolved.
struct Curve {
  std::string label;
  std::vector<double> continuous;
  std::vector<double> on_grid;
};

struct Sweep {
  double tick_s = 0.0;
  double damping_ratio = 0.0;
  std::vector<double> frequencies_hz;
  std::vector<Curve> curves;
};

constexpr int64_t kMostPoints = 1000000;

void set_frequencies(const SensitivityOptions& options, Sweep& sweep) {
  const double from = sim::parse_positive(options.from, "--from");
  const double to = sim::parse_positive(options.to, "--to");
  if (to <= from) throw sim::bad_argument("--to", options.to, "not above --from, a higher frequency is accepted");
  const int64_t points = sim::parse_integer(options.points, "--points", 2, kMostPoints);
  for (int64_t i = 0; i < points; ++i) {
    sweep.frequencies_hz.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(points - 1));
  }
}

Curve curve_of(const std::string& text, const Sweep& sweep) {
  const std::vector<sim::SpecifiedShaper> specs = sim::parse_shapers(text);
  const ShaperDesign design = sim::design_for(specs, sweep.tick_s);
  Curve curve{text, {}, {}};
  std::vector<std::vector<sim::ExactImpulse>> trains;
  for (const sim::SpecifiedShaper& spec : specs) trains.push_back(sim::continuous_impulses(spec));
  for (const double frequency : sweep.frequencies_hz) {
    const Mode plant{frequency, sweep.damping_ratio};
    long double continuous = 1.0L;  // V of a convolution is the product (Park (3))
    for (const auto& train : trains) continuous *= sim::residual(train, plant);
    curve.continuous.push_back(static_cast<double>(continuous));
    curve.on_grid.push_back(static_cast<double>(sim::residual_on_grid(design, plant, sweep.tick_s)));
  }
  return curve;
}

Sweep swept(const SensitivityOptions& options) {
  Sweep sweep;
  sweep.tick_s = tick_of(options.tick);
  set_frequencies(options, sweep);
  const std::vector<sim::SpecifiedShaper> all = specs_of(options.shaper);
  if (!options.damping.empty()) {
    sweep.damping_ratio = sim::parse_number(options.damping, "--damping");
    if (!Mode{1.0, sweep.damping_ratio}.validate().ok())
      throw sim::bad_argument("--damping", options.damping, "out of range, a ratio from 0 to below 1 is accepted");
  } else if (!all.empty()) {
    sweep.damping_ratio = all[0].mode.damping_ratio;
  }
  for (const std::string& text : options.shaper.specs) sweep.curves.push_back(curve_of(text, sweep));
  return sweep;
}

void write_csv(const std::string& path, const Sweep& sweep) {
  Settings settings = {{"tick", sim::shortest(sweep.tick_s) + " s"},
                       {"damping ratio of the plant", sim::shortest(sweep.damping_ratio)}};
  std::vector<std::string> columns = {"frequency_hz"};
  for (size_t i = 0; i < sweep.curves.size(); ++i) {
    const std::string number = i == 0 ? "" : "_" + std::to_string(i + 1);
    settings.emplace_back("shaper " + std::to_string(i + 1), sweep.curves[i].label);
    columns.push_back("residual_continuous" + number);
    columns.push_back("residual_on_grid" + number);
  }
  CsvFile csv(path, "sensitivity", settings, columns);
  for (size_t k = 0; k < sweep.frequencies_hz.size(); ++k) {
    std::vector<std::string> cells = {sim::shortest(sweep.frequencies_hz[k])};
    for (const Curve& curve : sweep.curves) {
      cells.push_back(sim::shortest(curve.continuous[k]));
      cells.push_back(sim::shortest(curve.on_grid[k]));
    }
    csv.row(cells);
  }
  csv.close();
}

Picture picture_of(const Sweep& sweep) {
  constexpr const char* kColours[] = {kShapedColour, kPlainColour, "#1b9e77", "#7570b3", "#e7298a", "#66a61e"};
  Panel panel{"What is left of a vibration, on the tick grid", "frequency of the arm [Hz]", "residual [%]", {}, {}};
  for (size_t i = 0; i < sweep.curves.size(); ++i) {
    Series series{sweep.curves[i].label, line_style(kColours[i % std::size(kColours)], 2), sweep.frequencies_hz, {}};
    for (const double residual : sweep.curves[i].on_grid) series.y.push_back(100.0 * residual);
    panel.series.push_back(series);
  }
  return Picture{"stillpoint sensitivity, damping ratio " + figure(sweep.damping_ratio), {panel}};
}

void print_as_json(const Sweep& sweep) {
  Json curves = Json::array();
  for (const Curve& curve : sweep.curves) {
    curves.push_back(
        {{"shaper", curve.label}, {"residual_continuous", curve.continuous}, {"residual_on_grid", curve.on_grid}});
  }
  print_json({{"result", "ok"},
              {"tick_s", sweep.tick_s},
              {"damping_ratio", sweep.damping_ratio},
              {"frequency_hz", sweep.frequencies_hz},
              {"curves", curves}});
}

// At most this many lines for people; the CSV has them all.
constexpr size_t kTableLines = 41;

void print_as_table(const Sweep& sweep) {
  std::vector<std::string> head = {"frequency [Hz]"};
  for (const Curve& curve : sweep.curves) head.push_back(curve.label + " [%]");
  Table table(head);
  const size_t stride = (sweep.frequencies_hz.size() + kTableLines - 1) / kTableLines;
  for (size_t k = 0; k < sweep.frequencies_hz.size(); k += stride) {
    std::vector<std::string> cells = {fmt::format("{:.4f}", sweep.frequencies_hz[k])};
    for (const Curve& curve : sweep.curves) cells.push_back(fmt::format("{:.4f}", 100.0 * curve.on_grid[k]));
    table.row(cells);
  }
  table.print();
}

int run(const SensitivityOptions& options, const Output& output) {
  check_output(output);
  const Sweep sweep = swept(options);
  if (!output.csv.empty()) write_csv(output.csv, sweep);
  if (!output.plot.empty()) draw(output.plot, picture_of(sweep));
  if (output.json) {
    print_as_json(sweep);
  } else {
    print_as_table(sweep);
  }
  return 0;
}

}  // namespace

void add_sensitivity(Commands& commands, Output& output) {
  const auto options = std::make_shared<SensitivityOptions>();
  CLI::App& app = commands.add("sensitivity", "Residual vibration over the frequency of the arm; a curve a --shaper.",
                               [options, &output] { return run(*options, output); });
  add_shaper(app, options->shaper);
  add_tick(app, options->tick);
  add_required(app, "--from", options->from, "HZ", "lowest frequency of the arm");
  add_required(app, "--to", options->to, "HZ", "highest frequency of the arm");
  add_value(app, "--points", options->points, "N", "frequencies, both ends included (default 200)");
  add_value(app, "--damping", options->damping, "Z", "damping ratio of the arm (default: the first shaper's)");
  add_output(app, output);
}

}  // namespace stillpoint::cli
