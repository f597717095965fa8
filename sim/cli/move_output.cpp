// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/move_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/cli/json.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

Json json_of_figures(const sim::MoveFigures& figures) {
  return {{"move_time_s", figures.move_time_s},
          {"residual_peak", figures.residual_peak},
          {"settling_time_s", optional_number(figures.settling_time_s)},
          {"total_time_s", optional_number(figures.total_time_s)},
          {"peak_velocity", figures.stream.peak_velocity},
          {"peak_acceleration", figures.stream.peak_acceleration},
          {"peak_jerk", figures.stream.peak_jerk},
          {"within_limits", figures.stream.within_limits}};
}

// How long to look at the arm after the later of the two moves: until the plain one is long settled.
constexpr double kShortestTail = 0.3;
constexpr double kLongestTail = 3.0;

double tail_s(const sim::Comparison& comparison) {
  return std::clamp(2.0 * comparison.plain_figures.settling_time_s.value_or(kLongestTail), kShortestTail, kLongestTail);
}

struct Traces {
  size_t ticks;
  sim::ArmTrace plain;
  sim::ArmTrace shaped;
};

Traces traces_of(const MoveJob& job, const sim::Comparison& comparison) {
  const double end = std::max(comparison.plain_figures.move_time_s, comparison.shaped_figures.move_time_s);
  const size_t ticks = static_cast<size_t>(std::ceil((end + tail_s(comparison)) / job.plain.tick_s)) + 1;
  return Traces{ticks, sim::simulate_arm(comparison.plain.setpoints, job.plain, job.arm, ticks),
                sim::simulate_arm(comparison.shaped.setpoints, job.shaped, job.arm, ticks)};
}

Signal at(const std::vector<Signal>& setpoints, size_t tick) { return setpoints[std::min(tick, setpoints.size() - 1)]; }

// One curve over time; `values` from `begin` on, each less `offset`.
Series curve(const std::string& label, const std::string& style, double tick_s, const std::vector<double>& values,
             size_t begin, double offset) {
  Series series{label, style, {}, {}};
  for (size_t i = begin; i < values.size(); ++i) {
    series.x.push_back(static_cast<double>(i) * tick_s);
    series.y.push_back(values[i] - offset);
  }
  return series;
}

std::vector<Series> position_curves(double tick_s, const Traces& traces, size_t begin, double offset) {
  return {curve("plain: setpoint", line_style(kPlainColour, 1.5, true), tick_s, traces.plain.motor, begin, offset),
          curve("plain: arm tip", line_style(kPlainColour, 2.0), tick_s, traces.plain.tip, begin, offset),
          curve("shaped: setpoint", line_style(kShapedColour, 1.5, true), tick_s, traces.shaped.motor, begin, offset),
          curve("shaped: arm tip", line_style(kShapedColour, 2.0), tick_s, traces.shaped.tip, begin, offset)};
}

// What the tip goes through from its own last setpoint change on, with the time counted from there.
Series residual_curve(const std::string& label, const std::string& colour, double tick_s,
                      const std::vector<double>& acceleration, double move_time_s) {
  const size_t begin = static_cast<size_t>(std::llround(move_time_s / tick_s));
  Series series{label, line_style(colour, 2.0), {}, {}};
  for (size_t i = begin; i < acceleration.size(); ++i) {
    series.x.push_back(static_cast<double>(i - begin) * tick_s);
    series.y.push_back(acceleration[i]);
  }
  return series;
}

}  // namespace

Settings settings_of(const MoveJob& job) {
  Settings settings = settings_of(job.plain);
  for (const sim::SpecifiedShaper& spec : job.specs) settings.emplace_back("shaper", sim::spec_text(spec));
  for (const sim::ArmMode& mode : job.arm) {
    settings.emplace_back("arm mode", sim::shortest(mode.mode.frequency_hz) + " Hz, damping ratio " +
                                          sim::shortest(mode.mode.damping_ratio) + ", share " +
                                          sim::shortest(mode.share));
  }
  const bool own = job.shaped.duration_s > 0.0;
  if (job.shaped.zero_delay) {
    settings.emplace_back("zero delay within", own ? sim::shortest(job.shaped.duration_s) + " s" : "the least time");
  }
  settings.emplace_back("settle band", sim::shortest(job.settle_band));
  return settings;
}

Json json_of(const sim::Comparison& comparison) {
  return {{"plain", json_of_figures(comparison.plain_figures)},
          {"shaped", json_of_figures(comparison.shaped_figures)},
          {"residual_ratio", comparison.residual_ratio},
          {"within_limits", comparison.within_limits},
          {"zero_delay_met", comparison.zero_delay_met}};
}

Table figures_table() {
  return Table({"", "move [s]", "residual [unit/s^2]", "of plain", "settling [s]", "total [s]", "peak v [unit/s]",
                "a [unit/s^2]", "j [unit/s^3]", "limits"});
}

void add_figures(Table& table, const std::string& name, const sim::MoveFigures& figures, double residual_ratio) {
  table.row({name, seconds(figures.move_time_s), figure(figures.residual_peak), figure(residual_ratio),
             seconds(figures.settling_time_s), seconds(figures.total_time_s), figure(figures.stream.peak_velocity),
             figure(figures.stream.peak_acceleration), figure(figures.stream.peak_jerk),
             figures.stream.within_limits ? "held" : "BROKEN"});
}

void print_comparison(const sim::Comparison& comparison) {
  Table table = figures_table();
  add_figures(table, "plain", comparison.plain_figures, 1.0);
  add_figures(table, "shaped", comparison.shaped_figures, comparison.residual_ratio);
  table.print();
  fmt::print("zero delay met: {}\n", yes_no(comparison.zero_delay_met));
}

void print_timing(const MoveReport& report) {
  fmt::print("timing of the shaped move: {}, {} ticks", text(report.timing), report.total_ticks);
  fmt::print(report.binding == Quantity::kNone ? "\n" : ", bound by {}\n", text(report.binding));
}

void add_timing(Json& object, const MoveReport& report) {
  object["shaped"]["timing"] = text(report.timing);
  object["shaped"]["binding"] = report.binding == Quantity::kNone ? Json(nullptr) : Json(text(report.binding));
  object["shaped"]["total_ticks"] = report.total_ticks;
}

void write_move_csv(const std::string& path, const std::string& command, const MoveJob& job,
                    const sim::Comparison& comparison) {
  CsvFile csv(
      path, command, settings_of(job),
      {"tick", "time_s", "plain_setpoint_counts", "plain_setpoint", "plain_motor", "plain_arm", "plain_acceleration",
       "shaped_setpoint_counts", "shaped_setpoint", "shaped_motor", "shaped_arm", "shaped_acceleration"});
  const Traces traces = traces_of(job, comparison);
  const double unit = job.plain.counts_per_unit * static_cast<double>(kSignalPerCount);
  for (size_t i = 0; i < traces.ticks; ++i) {
    const Signal plain = at(comparison.plain.setpoints, i);
    const Signal shaped = at(comparison.shaped.setpoints, i);
    csv.row({std::to_string(i), sim::shortest(static_cast<double>(i) * job.plain.tick_s), sim::exact_counts(plain),
             sim::shortest(static_cast<double>(plain) / unit), sim::shortest(traces.plain.motor[i]),
             sim::shortest(traces.plain.tip[i]), sim::shortest(traces.plain.acceleration[i]), sim::exact_counts(shaped),
             sim::shortest(static_cast<double>(shaped) / unit), sim::shortest(traces.shaped.motor[i]),
             sim::shortest(traces.shaped.tip[i]), sim::shortest(traces.shaped.acceleration[i])});
  }
  csv.close();
}

Picture picture_of(const std::string& title, const MoveJob& job, const sim::Comparison& comparison) {
  const Traces traces = traces_of(job, comparison);
  const double tick_s = job.plain.tick_s;
  const double first = std::min(comparison.plain_figures.move_time_s, comparison.shaped_figures.move_time_s);
  const double end = static_cast<double>(traces.ticks) * tick_s;
  const double from = std::max(0.0, first - 0.3 * (end - first));
  const size_t begin = static_cast<size_t>(from / tick_s);
  const double target = job.plain.distance_counts / job.plain.counts_per_unit;
  Panel whole{"The whole move: setpoint and arm tip",  "time [s]",    "position [unit]", {{0.0, end}},
              position_curves(tick_s, traces, 0, 0.0), "right bottom"};
  Panel arrival{"The arrival, enlarged: distance from the target", "time [s]",    "from target [unit]", {{from, end}},
                position_curves(tick_s, traces, begin, target),    "right bottom"};
  // The approach is far from the target; what matters is the ringing about it.
  double ringing = 0.0;
  for (size_t i = static_cast<size_t>(first / tick_s); i < traces.ticks; ++i) {
    ringing = std::max(ringing, std::abs(traces.plain.tip[i] - target));
  }
  if (ringing > 0.0) arrival.y_range = {{-1.5 * ringing, 1.5 * ringing}};
  Panel residual{
      "Arm tip after the last setpoint change: acceleration",
      "time since then [s]",
      "unit/s^2",
      {{0.0, tail_s(comparison)}},
      {residual_curve("plain", kPlainColour, tick_s, traces.plain.acceleration, comparison.plain_figures.move_time_s),
       residual_curve("shaped", kShapedColour, tick_s, traces.shaped.acceleration,
                      comparison.shaped_figures.move_time_s)}};
  return Picture{title, {whole, arrival, residual}};
}

}  // namespace stillpoint::cli
