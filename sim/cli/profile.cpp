// SPDX-License-Identifier: Apache-2.0
// `stillpoint profile`: plans a move and samples it.
#include <fmt/format.h>

#include <array>
#include <memory>

#include "shaper/profile/plan.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/csv.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/options.hpp"
#include "sim/cli/plot.hpp"
#include "sim/cli/progress.hpp"
#include "sim/cli/table.hpp"
#include "sim/evaluation.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct Sampled {
  sim::MoveTask task;
  sim::Recording recording;
  Plan plan;  // counts and ticks, stretched as emitted
  sim::StreamFigures figures;
};

// Backward differences of the emitted setpoints, in units: what a drive sees.
struct Kinematics {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};

std::vector<Kinematics> kinematics_of(const Sampled& sampled) {
  const long double dt = static_cast<long double>(sampled.task.tick_s);
  const long double unit =
      static_cast<long double>(sampled.task.counts_per_unit) * static_cast<long double>(kSignalPerCount);
  std::vector<Kinematics> rows;
  std::array<long double, 4> last{};
  for (uint32_t i = 0; i <= sampled.recording.report.total_ticks; ++i) {
    std::array<long double, 4> now{};
    now[0] = static_cast<long double>(sampled.recording.setpoints[i]);
    if (i > 0) {
      for (size_t k = 1; k < now.size(); ++k) now[k] = now[k - 1] - last[k - 1];
    }
    const long double s = dt * unit;
    rows.push_back({static_cast<double>(now[0] / unit), static_cast<double>(now[1] / s),
                    static_cast<double>(now[2] / (s * dt)), static_cast<double>(now[3] / (s * dt * dt))});
    last = now;
  }
  return rows;
}

Sampled sample(const MoveOptions& options) {
  Sampled sampled{task_of(options), {}, {}, {}};
  const sim::MoveTask& task = sampled.task;
  Progress progress("sampling");
  sampled.recording = sim::run_axis(task, ShaperDesign{}, [&](double part) { progress.update(part); });
  sampled.figures = sim::evaluate_stream(sampled.recording.setpoints, task, 0);
  // The plan behind it, for its phases.
  sim::require(plan_rest_to_rest(task.distance_counts, task.limits, task.kind, task.tick_s, sampled.plan),
               task.counts_per_unit);
  if (task.distance_counts != 0) {
    sim::require(stretch(sampled.plan, sampled.recording.report.profile_ticks), task.counts_per_unit);
  }
  return sampled;
}

struct Phase {
  double start_s;
  double duration_s;
  double acceleration;  // at its start
  double jerk;
};

std::vector<Phase> phases_of(const Sampled& sampled) {
  const double dt = sampled.task.tick_s;
  const double unit = sampled.task.counts_per_unit;
  std::vector<Phase> phases;
  double start = 0.0;
  for (uint32_t i = 0; i < sampled.plan.segment_count; ++i) {
    const Segment& segment = sampled.plan.segments[i];
    phases.push_back({start, segment.duration_ticks * dt, segment.acceleration / unit / dt / dt,
                      segment.jerk / unit / dt / dt / dt});
    start += segment.duration_ticks * dt;
  }
  return phases;
}

void print_as_json(const Sampled& sampled) {
  Json phases = Json::array();
  for (const Phase& phase : phases_of(sampled)) {
    phases.push_back({{"start_s", phase.start_s},
                      {"duration_s", phase.duration_s},
                      {"acceleration", phase.acceleration},
                      {"jerk", phase.jerk}});
  }
  print_json({{"result", sampled.figures.within_limits ? "ok" : "limits_broken"},
              {"kind", kind_name(sampled.task.kind)},
              {"distance", sampled.task.distance_counts / sampled.task.counts_per_unit},
              {"tick_s", sampled.task.tick_s},
              {"duration_s", sampled.recording.report.optimum_ticks * sampled.task.tick_s},
              {"duration_ticks", sampled.recording.report.profile_ticks},
              {"peak_velocity", sampled.figures.peak_velocity},
              {"peak_acceleration", sampled.figures.peak_acceleration},
              {"peak_jerk", sampled.figures.peak_jerk},
              {"within_limits", sampled.figures.within_limits},
              {"phases", phases}});
}

void print_as_table(const Sampled& sampled) {
  const double unit = sampled.task.counts_per_unit;
  const double dt = sampled.task.tick_s;
  const AxisLimits& limits = sampled.task.limits;
  const uint32_t ticks = sampled.recording.report.profile_ticks;
  fmt::print("{} over {} unit: {} ticks, {} s (continuous optimum {} s)\n\n", kind_name(sampled.task.kind),
             sim::shortest(sampled.task.distance_counts / unit), ticks, seconds(ticks * dt),
             seconds(sampled.recording.report.optimum_ticks * dt));
  Table peaks({"of the emitted stream", "peak", "limit", ""});
  peaks.row({"velocity", figure(sampled.figures.peak_velocity), figure(limits.velocity / unit), "unit/s"});
  peaks.row(
      {"acceleration", figure(sampled.figures.peak_acceleration), figure(limits.acceleration / unit), "unit/s^2"});
  const bool jerk_limited = sampled.task.kind == ProfileKind::kSCurve;
  peaks.row(
      {"jerk", figure(sampled.figures.peak_jerk), jerk_limited ? figure(limits.jerk / unit) : "none", "unit/s^3"});
  peaks.print();
  fmt::print("within limits: {}\n\n", yes_no(sampled.figures.within_limits));
  Table phases({"phase", "start [s]", "duration [s]", "acceleration [unit/s^2]", "jerk [unit/s^3]"});
  int number = 0;
  for (const Phase& phase : phases_of(sampled)) {
    phases.row({std::to_string(++number), seconds(phase.start_s), seconds(phase.duration_s), figure(phase.acceleration),
                figure(phase.jerk)});
  }
  phases.print();
}

void write_csv(const std::string& path, const Sampled& sampled) {
  CsvFile csv(path, "profile", settings_of(sampled.task),
              {"tick", "time_s", "position_counts", "position", "velocity", "acceleration", "jerk"});
  uint32_t tick = 0;
  for (const Kinematics& row : kinematics_of(sampled)) {
    csv.row({std::to_string(tick), sim::shortest(tick * sampled.task.tick_s),
             sim::exact_counts(sampled.recording.setpoints[tick]), sim::shortest(row.position),
             sim::shortest(row.velocity), sim::shortest(row.acceleration), sim::shortest(row.jerk)});
    ++tick;
  }
  csv.close();
}

Picture picture_of(const Sampled& sampled) {
  const std::vector<Kinematics> rows = kinematics_of(sampled);
  const auto panel = [&](const char* title, const char* label, double Kinematics::*value) {
    Series series{"", line_style(kShapedColour, 2), {}, {}};
    for (size_t i = 0; i < rows.size(); ++i) {
      series.x.push_back(static_cast<double>(i) * sampled.task.tick_s);
      series.y.push_back(rows[i].*value);
    }
    return Panel{title, "time [s]", label, {}, {series}};
  };
  return Picture{
      "stillpoint profile",
      {panel("Position", "unit", &Kinematics::position), panel("Velocity", "unit/s", &Kinematics::velocity),
       panel("Acceleration", "unit/s^2", &Kinematics::acceleration), panel("Jerk", "unit/s^3", &Kinematics::jerk)}};
}

int run(const MoveOptions& options, const Output& output) {
  check_output(output);
  const Sampled sampled = sample(options);
  if (!output.csv.empty()) write_csv(output.csv, sampled);
  if (!output.plot.empty()) draw(output.plot, picture_of(sampled));
  if (output.json) {
    print_as_json(sampled);
  } else {
    print_as_table(sampled);
  }
  return exit_code_of(sampled.figures.within_limits);
}

}  // namespace

void add_profile(Commands& commands, Output& output) {
  const auto options = std::make_shared<MoveOptions>();
  CLI::App& app = commands.add("profile", "Plans a move from rest to rest and samples it on the ticks.",
                               [options, &output] { return run(*options, output); });
  add_move_options(app, *options);
  add_output(app, output);
}

}  // namespace stillpoint::cli
