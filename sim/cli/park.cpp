// SPDX-License-Identifier: Apache-2.0
// `stillpoint park`: the experiments of Park 2001 beside the paper's figures.
#include <fmt/format.h>

#include "sim/cli/command.hpp"
#include "sim/cli/csv.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/plot.hpp"
#include "sim/cli/table.hpp"
#include "sim/park.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

std::string label_of(const sim::ParkRow& row) {
  return fmt::format("Fig. {}: {}{}", row.figure, row.quantity, row.unit.empty() ? "" : " [" + row.unit + "]");
}

std::string plant_text(const sim::TwoMassParameters& plant) {
  return fmt::format("k = {:g} N/m, c = {:g} N s/m: {:.2f} Hz, damping ratio {:.2g}", plant.stiffness_n_per_m,
                     plant.damping_n_s_per_m, plant.mode().frequency_hz, plant.mode().damping_ratio);
}

void print_as_table(const sim::ParkExperiments& park) {
  Table table({"quantity", "paper", "continuous shaper", "plant, shaper as run"});
  for (const sim::ParkRow& row : park.rows) {
    table.row({label_of(row), row.paper ? fmt::format("{:g}", *row.paper) : "-", fmt::format("{:.4f}", row.continuous),
               fmt::format("{:.4f}", row.on_plant)});
  }
  table.print();
  fmt::print(
      "\nShapers for 4 Hz and humps of 5 %, run at 1 ms; f is 4 Hz. Damping ratio 0.1 in Figs. 10 and 17, else 0.\n");
  for (const sim::ParkResponse& response : park.responses)
    fmt::print("Fig. {}: {}\n", response.figure, plant_text(response.plant));
  fmt::print(
      "A residual is the amplitude at the last impulse over that of the unshaped step at the step. The last tap comes\n"
      "up to a tick a stage after the last impulse: with damping the plant has by then calmed a little further.\n");
}

void print_as_json(const sim::ParkExperiments& park) {
  Json rows = Json::array();
  for (const sim::ParkRow& row : park.rows) {
    rows.push_back({{"figure", row.figure},
                    {"quantity", row.quantity},
                    {"unit", row.unit},
                    {"paper", optional_number(row.paper)},
                    {"continuous", row.continuous},
                    {"on_plant", row.on_plant}});
  }
  Json plants = Json::array();
  for (const sim::ParkResponse& response : park.responses) {
    plants.push_back({{"figure", response.figure},
                      {"mass_kg", response.plant.mass_kg},
                      {"stiffness_n_per_m", response.plant.stiffness_n_per_m},
                      {"damping_n_s_per_m", response.plant.damping_n_s_per_m},
                      {"frequency_hz", response.plant.mode().frequency_hz},
                      {"damping_ratio", response.plant.mode().damping_ratio}});
  }
  print_json({{"result", "ok"}, {"tick_s", sim::kParkTick}, {"rows", rows}, {"plants", plants}});
}

double time_of(size_t tick) { return static_cast<double>(tick) * sim::kParkTick; }

void write_csv(const std::string& path, const sim::ParkExperiments& park) {
  Settings settings = {{"tick", sim::shortest(sim::kParkTick) + " s"}};
  std::vector<std::string> columns = {"time_s"};
  for (const sim::ParkResponse& response : park.responses) {
    const std::string figure = std::to_string(response.figure);
    settings.emplace_back("figure " + figure, plant_text(response.plant));
    columns.push_back("ei_" + figure);
    columns.push_back("cv_" + figure);
  }
  CsvFile csv(path, "park", settings, columns);
  for (size_t tick = 0; tick < park.responses[0].convolution.size(); ++tick) {
    std::vector<std::string> cells = {sim::shortest(time_of(tick))};
    for (const sim::ParkResponse& response : park.responses) {
      cells.push_back(sim::shortest(response.extra_insensitive[tick]));
      cells.push_back(sim::shortest(response.convolution[tick]));
    }
    csv.row(cells);
  }
  csv.close();
}

Picture picture_of(const sim::ParkExperiments& park) {
  Picture picture{"Park 2001, Figs. 15-17: the far mass after a shaped unit step", {}};
  for (const sim::ParkResponse& response : park.responses) {
    Panel panel{fmt::format("Fig. {}: {}", response.figure, plant_text(response.plant)),
                "time [s]",
                "x2 over the step",
                std::pair(0.0, time_of(response.convolution.size())),
                {},
                "right bottom"};
    std::vector<double> times;
    for (size_t tick = 0; tick < response.convolution.size(); ++tick) times.push_back(time_of(tick));
    panel.series.push_back({"three-hump EI", line_style(kPlainColour, 2, true), times, response.extra_insensitive});
    panel.series.push_back({"three-hump CV", line_style(kShapedColour, 2), times, response.convolution});
    picture.panels.push_back(panel);
  }
  return picture;
}

int run(const Output& output) {
  check_output(output);
  const sim::ParkExperiments park = sim::run_park();
  if (!output.csv.empty()) write_csv(output.csv, park);
  if (!output.plot.empty()) draw(output.plot, picture_of(park));
  if (output.json) {
    print_as_json(park);
  } else {
    print_as_table(park);
  }
  return 0;
}

}  // namespace

void add_park(Commands& commands, Output& output) {
  CLI::App& app =
      commands.add("park", "Park's experiments (2001, Figs. 10, 13, 15-17) again, beside the paper's figures.",
                   [&output] { return run(output); });
  add_output(app, output);
}

}  // namespace stillpoint::cli
