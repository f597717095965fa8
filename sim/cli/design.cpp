// SPDX-License-Identifier: Apache-2.0
// `stillpoint design`: shapers on the tick grid, and what they are good for.
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

using sim::SpecifiedShaper;

struct Designed {
  double tick_s;
  std::vector<SpecifiedShaper> specs;
  ShaperDesign design;  // of all of them
  std::vector<sim::ImpulseTap> taps;
};

struct Quality {
  double residual_on_grid;
  sim::Band band;
  PlacementReport placement;
};

Quality quality_of(const SpecifiedShaper& spec, double tick_s) {
  ShaperDesign alone{};
  PlacementReport placement{};
  sim::require(stillpoint::add_shaper(spec, tick_s, alone, &placement));
  return Quality{static_cast<double>(sim::residual_on_grid(alone, spec.mode, tick_s)),
                 sim::tolerated_band(alone, spec, tick_s), placement};
}

Json json_of(const SpecifiedShaper& spec, double tick_s) {
  const Quality quality = quality_of(spec, tick_s);
  Json impulses = Json::array();
  for (const sim::ExactImpulse& impulse : sim::continuous_impulses(spec)) {
    impulses.push_back(
        {{"time_s", static_cast<double>(impulse.time_s)}, {"amplitude", static_cast<double>(impulse.amplitude)}});
  }
  return {{"type", text(spec.kind)},
          {"frequency_hz", spec.mode.frequency_hz},
          {"damping_ratio", spec.mode.damping_ratio},
          {"tolerance", spec.tolerance},
          {"impulses", impulses},
          {"residual_on_grid", quality.residual_on_grid},
          {"low_ratio", quality.band.low_ratio},
          {"high_ratio", quality.band.high_ratio},
          {"band_miss", quality.placement.band_miss},
          {"negative_tap", quality.placement.has_negative_tap}};
}

Json stages_of(const ShaperDesign& design) {
  Json stages = Json::array();
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    const Stage& stage = design.stages[i];
    Json taps = Json::array();
    for (uint32_t k = stage.first_tap; k < stage.first_tap + stage.tap_count; ++k) {
      taps.push_back({{"delay_ticks", design.taps[k].delay_ticks},
                      {"gain", exact_number(sim::exact_decimal(design.taps[k].gain, kGainFractionBits))}});
    }
    stages.push_back(taps);
  }
  return stages;
}

void print_as_json(const Designed& designed) {
  Json shapers = Json::array();
  for (const SpecifiedShaper& spec : designed.specs) shapers.push_back(json_of(spec, designed.tick_s));
  Json object = {{"result", "ok"}, {"tick_s", designed.tick_s}, {"shapers", shapers}};
  object["stages"] = stages_of(designed.design);
  if (!designed.taps.empty()) {
    Json taps = Json::array();
    for (const sim::ImpulseTap& tap : designed.taps) {
      taps.push_back({{"delay_ticks", tap.delay_ticks}, {"gain", static_cast<double>(tap.gain)}});
    }
    object["taps"] = taps;
  }
  object["length_ticks"] = designed.design.length_ticks();
  object["delay_s"] = designed.design.delay_ticks() * designed.tick_s;
  object["peak_gain"] = static_cast<double>(sim::peak_gain(designed.design));
  const sim::FrequencyGain highest = sim::highest_gain(designed.design, designed.tick_s);
  object["highest_gain"] = highest.gain;
  object["highest_gain_hz"] = highest.frequency_hz;
  print_json(object);
}

void print_as_table(const Designed& designed) {
  Table shapers({"shaper", "residual on grid", "tolerance", "band from", "to [of f]", "miss on grid"});
  bool negative = false;
  for (const SpecifiedShaper& spec : designed.specs) {
    const Quality quality = quality_of(spec, designed.tick_s);
    shapers.row({sim::spec_text(spec), fmt::format("{:.2e}", quality.residual_on_grid), figure(spec.tolerance),
                 fmt::format("{:.5f}", quality.band.low_ratio), fmt::format("{:.5f}", quality.band.high_ratio),
                 fmt::format("{:.2f}", quality.placement.band_miss)});
    negative = negative || quality.placement.has_negative_tap;
  }
  shapers.print();
  fmt::print("\n");
  Table stages({"stage", "delay [ticks]", "gain"});
  for (uint32_t i = 0; i < designed.design.stage_count; ++i) {
    const Stage& stage = designed.design.stages[i];
    for (uint32_t k = stage.first_tap; k < stage.first_tap + stage.tap_count; ++k) {
      const Tap& tap = designed.design.taps[k];
      stages.row({std::to_string(i + 1), std::to_string(tap.delay_ticks),
                  fmt::format("{:.10f}", static_cast<double>(tap.gain) / kUnityGain)});
    }
  }
  stages.print();
  const double peak = static_cast<double>(sim::peak_gain(designed.design));
  const sim::FrequencyGain highest = sim::highest_gain(designed.design, designed.tick_s);
  fmt::print("\nlength {} ticks, delay {:.6f} s (centroid)\n", designed.design.length_ticks(),
             designed.design.delay_ticks() * designed.tick_s);
  fmt::print("peak gain {:.6g}: of position, velocity and acceleration; highest gain {:.6g}, of {:.4g} Hz\n", peak,
             highest.gain, highest.frequency_hz);
  if (negative) fmt::print("the ticks force a negative tap on a shaper that has none\n");
}

void write_csv(const std::string& path, const Designed& designed) {
  Settings settings = {{"tick", sim::shortest(designed.tick_s) + " s"}};
  for (const SpecifiedShaper& spec : designed.specs) settings.emplace_back("shaper", sim::spec_text(spec));
  CsvFile csv(path, "design", settings, {"delay_ticks", "time_s", "gain"});
  for (const sim::ImpulseTap& tap : designed.taps) {
    csv.row({std::to_string(tap.delay_ticks), sim::shortest(tap.delay_ticks * designed.tick_s),
             sim::shortest(static_cast<double>(tap.gain))});
  }
  csv.close();
}

Picture picture_of(const Designed& designed) {
  Panel impulses{"Impulses as run", "time [s]", "gain", {}, {}};
  Series taps{"taps on the grid", std::string("impulses lw 3 lc rgb '") + kShapedColour + "'", {}, {}};
  for (const sim::ImpulseTap& tap : designed.taps) {
    taps.x.push_back(tap.delay_ticks * designed.tick_s);
    taps.y.push_back(static_cast<double>(tap.gain));
  }
  impulses.series.push_back(taps);
  Panel sensitivity{"What is left of a vibration of another frequency", "frequency [Hz]", "residual [%]", {}, {}};
  Series residual{"residual", line_style(kShapedColour, 2), {}, {}};
  double highest = 0.0;
  for (const SpecifiedShaper& spec : designed.specs) highest = std::max(highest, spec.mode.frequency_hz);
  constexpr int kPoints = 800;
  const double damping = designed.specs.empty() ? 0.0 : designed.specs[0].mode.damping_ratio;
  for (int i = 1; i <= kPoints; ++i) {
    const double frequency = std::min(2.5 * highest, 0.5 / designed.tick_s) * i / kPoints;
    residual.x.push_back(frequency);
    residual.y.push_back(
        100.0 * static_cast<double>(sim::residual_on_grid(designed.design, {frequency, damping}, designed.tick_s)));
  }
  sensitivity.series.push_back(residual);
  return Picture{"stillpoint design", {impulses, sensitivity}};
}

int run(const ShaperOption& shaper, const TickOption& tick, const Output& output) {
  check_output(output);
  Designed designed{};
  designed.tick_s = tick_of(tick);
  designed.specs = specs_of(shaper);
  designed.design = sim::design_for(designed.specs, designed.tick_s);
  designed.taps = sim::multiplied_out(designed.design, sim::kMostTaps);
  if (!output.csv.empty()) write_csv(output.csv, designed);
  if (!output.plot.empty()) draw(output.plot, picture_of(designed));
  if (output.json) {
    print_as_json(designed);
  } else {
    print_as_table(designed);
  }
  return 0;
}

}  // namespace

void add_design(Commands& commands, Output& output) {
  const auto shaper = std::make_shared<ShaperOption>();
  const auto tick = std::make_shared<TickOption>();
  CLI::App& app = commands.add("design", "Designs shapers exactly on the tick grid.",
                               [shaper, tick, &output] { return run(*shaper, *tick, output); });
  add_shaper(app, *shaper);
  add_tick(app, *tick);
  add_output(app, output);
}

}  // namespace stillpoint::cli
