// SPDX-License-Identifier: Apache-2.0
// `stillpoint group`: several axes along one path, and what keeping them in step costs.
#include "shaper/shaping/group.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "sim/cli/command.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/options.hpp"
#include "sim/cli/table.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

struct Way {
  const char* name;
  ShaperCost cost;
  ContourLag lag;
};

Way way_of(const char* name, const std::vector<ShaperDesign>& axes) {
  size_t longest = 0;
  for (const ShaperDesign& axis : axes) longest = std::max(longest, Shaper::memory_needed(axis));
  std::vector<LineSample> memory(2 * longest);
  Way way{name, cost_of(axes.data(), axes.size()), {}};
  sim::require(worst_lag(axes.data(), axes.size(), memory.data(), memory.size(), way.lag));
  return way;
}

std::vector<Way> ways_of(const std::vector<ShaperDesign>& own) {
  std::vector<ShaperDesign> delayed = own;
  sim::require(equalise_delays(delayed.data(), delayed.size()));
  ShaperDesign common{};
  sim::require(common_shaper(own.data(), own.size(), common));
  return {way_of("own shapers", own), way_of("equal delays", delayed),
          way_of("common shaper", std::vector<ShaperDesign>(own.size(), common))};
}

void print_as_table(const std::vector<Way>& ways, double tick_s) {
  const double ms = 1e3 * tick_s;
  Table table({"", "delay [ms]", "length [ticks]", "line signals", "taps a tick", "lag: steady [ms]", "corner [ms]",
               "at worst [ms]"});
  for (const Way& way : ways) {
    table.row({way.name, fmt::format("{:.3f}", way.cost.delay_ticks * ms), std::to_string(way.cost.length_ticks),
               std::to_string(way.cost.line_signals), std::to_string(way.cost.taps_per_tick),
               fmt::format("{:.3f}", way.lag.steady_ticks * ms), fmt::format("{:.3f}", way.lag.corner_ticks * ms),
               fmt::format("{:.3f}", way.lag.worst_ticks * ms)});
  }
  table.print();
  fmt::print("\nLag between two axes: a ms of it is a mm at 1 m/s. Signals and taps: of all axes together.\n");
}

void print_as_json(const std::vector<Way>& ways, double tick_s) {
  Json rows = Json::array();
  for (const Way& way : ways) {
    rows.push_back({{"way", way.name},
                    {"delay_s", way.cost.delay_ticks * tick_s},
                    {"length_ticks", way.cost.length_ticks},
                    {"line_signals", way.cost.line_signals},
                    {"taps_per_tick", way.cost.taps_per_tick},
                    {"steady_lag_s", way.lag.steady_ticks * tick_s},
                    {"corner_lag_s", way.lag.corner_ticks * tick_s},
                    {"worst_lag_s", way.lag.worst_ticks * tick_s}});
  }
  print_json({{"result", "ok"}, {"ways", rows}});
}

int run(const ShaperOption& shaper, const TickOption& tick, const Output& output) {
  const double tick_s = tick_of(tick);
  std::vector<ShaperDesign> axes;
  for (const std::string& text : shaper.specs) axes.push_back(sim::design_for(sim::parse_shapers(text), tick_s));
  if (axes.size() < 2)
    throw sim::bad_argument("--shaper", std::to_string(axes.size()) + " axes",
                            "no group, a --shaper for each of at least 2 axes is accepted");
  const std::vector<Way> ways = ways_of(axes);
  if (output.json) {
    print_as_json(ways, tick_s);
  } else {
    print_as_table(ways, tick_s);
  }
  return 0;
}

}  // namespace

void add_group(Commands& commands, Output& output) {
  const auto shaper = std::make_shared<ShaperOption>();
  const auto tick = std::make_shared<TickOption>();
  CLI::App& app =
      commands.add("group",
                   "Several axes along one path, a --shaper each: what a common shaper or equal delays cost, "
                   "and how far apart the axes are driven.",
                   [shaper, tick, &output] { return run(*shaper, *tick, output); });
  add_shaper(app, *shaper);
  add_tick(app, *tick);
  add_json(app, output);
}

}  // namespace stillpoint::cli
