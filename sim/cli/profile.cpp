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

struct ProfileOptions : MoveOptions {
  std::string start_velocity;
  std::string start_acceleration;
};

struct Sampled {
  sim::MoveTask task;
  sim::Recording recording;
  Plan plan;  // counts and ticks, as emitted
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
    } else {
      // As if the acceleration of the start had always been there.
      const long double lsb = static_cast<long double>(kSignalPerCount);
      now[2] = static_cast<long double>(sampled.task.start.acceleration) * dt * dt * lsb;
      now[1] = static_cast<long double>(sampled.task.start.velocity) * dt * lsb - now[2] / 2.0L;
    }
    const long double s = dt * unit;
    rows.push_back({static_cast<double>(now[0] / unit), static_cast<double>(now[1] / s),
                    static_cast<double>(now[2] / (s * dt)), static_cast<double>(now[3] / (s * dt * dt))});
    last = now;
  }
  return rows;
}

// A start in motion is planned from by the one kind that can.
sim::MoveTask task_of_profile(const ProfileOptions& options) {
  sim::MoveTask task = task_of(options);
  const double unit = task.counts_per_unit;
  if (!options.start_velocity.empty())
    task.start.velocity = sim::parse_number(options.start_velocity, "--start-velocity") * unit;
  if (!options.start_acceleration.empty())
    task.start.acceleration = sim::parse_number(options.start_acceleration, "--start-acceleration") * unit;
  if (task.from_rest()) return task;
  const bool by_velocity = task.start.velocity != 0.0;
  const std::string name = by_velocity ? "--start-velocity" : "--start-acceleration";
  const std::string& value = by_velocity ? options.start_velocity : options.start_acceleration;
  if (task.profile.kind != ProfileKind::kSCurve)
    throw sim::bad_argument(name, value, "only an s-curve begins in motion, --kind s-curve is accepted");
  if (!options.duration.empty())
    throw sim::bad_argument("--duration", options.duration,
                            "a move that begins in motion takes the least time, it is accepted without " + name);
  return task;
}

Sampled sample(const ProfileOptions& options) {
  Sampled sampled{task_of_profile(options), {}, {}, {}};
  const sim::MoveTask& task = sampled.task;
  Progress progress("sampling");
  sampled.recording = task.from_rest()
                          ? sim::run_axis(task, ShaperDesign{}, [&](double part) { progress.update(part); })
                          : sim::run_from_motion(task);
  sampled.figures = sim::evaluate_stream(sampled.recording.setpoints, task, 0);
  sampled.plan = sim::plan_of(task, sampled.recording.report.profile_ticks);
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

// The phases of a plan of curve pieces.
struct Piece {
  double start_s;
  double duration_s;
  const char* shape;
  double distance;
};

const char* shape_of(const CurvePiece& piece) {
  if (piece.table == nullptr) return "cruise";
  if (piece.table == &kSineRampTable) return piece.reversed ? "sine ramp down" : "sine ramp up";
  if (piece.table == &kQuinticTable) return "poly5";
  return piece.table == &kSepticTable ? "poly7" : "table";
}

std::vector<Piece> pieces_of(const Sampled& sampled) {
  std::vector<Piece> pieces;
  double start = 0.0;
  for (uint32_t i = 0; i < sampled.plan.piece_count; ++i) {
    const CurvePiece& piece = sampled.plan.pieces[i];
    const double duration = piece.duration_ticks * sampled.task.tick_s;
    pieces.push_back({start, duration, shape_of(piece), piece.length / sampled.task.counts_per_unit});
    start += duration;
  }
  return pieces;
}

void print_as_json(const Sampled& sampled) {
  Json phases = Json::array();
  for (const Phase& phase : phases_of(sampled)) {
    phases.push_back({{"start_s", phase.start_s},
                      {"duration_s", phase.duration_s},
                      {"acceleration", phase.acceleration},
                      {"jerk", phase.jerk}});
  }
  for (const Piece& piece : pieces_of(sampled)) {
    phases.push_back({{"start_s", piece.start_s},
                      {"duration_s", piece.duration_s},
                      {"shape", piece.shape},
                      {"distance", piece.distance}});
  }
  print_json({{"result", sampled.figures.within_limits ? "ok" : "limits_broken"},
              {"kind", profile_text(sampled.task.profile)},
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

void print_phases(const Sampled& sampled) {
  int number = 0;
  if (sampled.plan.piece_count != 0) {
    Table pieces({"phase", "start [s]", "duration [s]", "shape", "distance [unit]"});
    for (const Piece& piece : pieces_of(sampled)) {
      pieces.row({std::to_string(++number), seconds(piece.start_s), seconds(piece.duration_s), piece.shape,
                  figure(piece.distance)});
    }
    return pieces.print();
  }
  Table phases({"phase", "start [s]", "duration [s]", "acceleration [unit/s^2]", "jerk [unit/s^3]"});
  for (const Phase& phase : phases_of(sampled)) {
    phases.row({std::to_string(++number), seconds(phase.start_s), seconds(phase.duration_s), figure(phase.acceleration),
                figure(phase.jerk)});
  }
  phases.print();
}

void print_as_table(const Sampled& sampled) {
  const double unit = sampled.task.counts_per_unit;
  const double dt = sampled.task.tick_s;
  const AxisLimits& limits = sampled.task.limits;
  const uint32_t ticks = sampled.recording.report.profile_ticks;
  fmt::print("{} over {} unit: {} ticks, {} s (continuous optimum {} s)\n\n", profile_text(sampled.task.profile),
             sim::shortest(sampled.task.distance_counts / unit), ticks, seconds(ticks * dt),
             seconds(sampled.recording.report.optimum_ticks * dt));
  Table peaks({"of the emitted stream", "peak", "limit", ""});
  peaks.row({"velocity", figure(sampled.figures.peak_velocity), figure(limits.velocity / unit), "unit/s"});
  peaks.row(
      {"acceleration", figure(sampled.figures.peak_acceleration), figure(limits.acceleration / unit), "unit/s^2"});
  const bool jerk_limited = sampled.task.profile.jerk_limited();
  peaks.row({"jerk", figure(sampled.figures.peak_jerk), jerk_limited ? figure(limits.larger_jerk() / unit) : "none",
             "unit/s^3"});
  peaks.print();
  fmt::print("within limits: {}\n\n", yes_no(sampled.figures.within_limits));
  print_phases(sampled);
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

int run(const ProfileOptions& options, const Output& output) {
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
  const auto options = std::make_shared<ProfileOptions>();
  CLI::App& app = commands.add("profile", "Plans a move to rest and samples it on the ticks.",
                               [options, &output] { return run(*options, output); });
  add_move_options(app, *options);
  add_value(app, "--start-velocity", options->start_velocity, "V", "velocity at the start [unit/s] (default 0)");
  add_value(app, "--start-acceleration", options->start_acceleration, "A",
            "acceleration at the start [unit/s^2] (default 0)");
  add_output(app, output);
}

}  // namespace stillpoint::cli
