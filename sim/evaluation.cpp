// SPDX-License-Identifier: Apache-2.0
#include "sim/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stillpoint::sim {
namespace {

constexpr double kSamplesPerPeriod = 64.0;  // the peak between two samples is at most 0.12 % higher

// Index of the last setpoint that differs from the one before it; 0 if none does.
size_t last_change(const std::vector<Signal>& setpoints) {
  size_t i = setpoints.size() - 1;
  while (i > 0 && setpoints[i] == setpoints[i - 1]) --i;
  return i;
}

double fastest_hz(const ArmModes& arm) {
  double fastest = 0.0;
  for (const ArmMode& mode : arm) fastest = std::max(fastest, mode.mode.frequency_hz);
  return fastest;
}

double slowest_hz(const ArmModes& arm) {
  double slowest = fastest_hz(arm);
  for (const ArmMode& mode : arm) slowest = std::min(slowest, mode.mode.frequency_hz);
  return slowest;
}

// Largest differences of the setpoints along the move, LSB.
struct Extremes {
  long double velocity;
  long double acceleration;
  long double deceleration;
  long double jerk;
};

// Long double holds a Signal exactly, and, unlike int64_t, the difference of any two.
Extremes extremes_of(const std::vector<Signal>& setpoints, long double direction) {
  Extremes extremes{};
  long double position = static_cast<long double>(setpoints[0]);
  long double velocity = 0.0L;
  long double acceleration = 0.0L;
  for (size_t i = 1; i < setpoints.size() + 3; ++i) {
    const long double next = static_cast<long double>(setpoints[std::min(i, setpoints.size() - 1)]);
    const long double step = direction * (next - position);
    const long double change = step - velocity;
    extremes.velocity = std::max(extremes.velocity, std::abs(step));
    extremes.acceleration = std::max(extremes.acceleration, change);
    extremes.deceleration = std::max(extremes.deceleration, -change);
    extremes.jerk = std::max(extremes.jerk, std::abs(change - acceleration));
    position = next;
    velocity = step;
    acceleration = change;
  }
  return extremes;
}

// The peak of a single mode comes within its first period; with more than one, beats may bring a later one.
double free_peak(Arm arm, const ArmModes& modes, double step_s) {
  if (modes.empty()) return 0.0;
  constexpr double kPeriods = 20.0;
  constexpr double kMostSamples = 2e6;
  const auto samples = static_cast<uint32_t>(std::min(kPeriods / slowest_hz(modes) / step_s, kMostSamples));
  double peak = std::abs(arm.acceleration());
  for (uint32_t i = 0; i < samples && arm.acceleration_envelope() > peak; ++i) {
    arm.step(0.0);
    peak = std::max(peak, std::abs(arm.acceleration()));
  }
  return peak;
}

}  // namespace

StreamFigures evaluate_stream(const std::vector<Signal>& setpoints, const MoveTask& task, uint32_t stage_count) {
  const Extremes extremes = extremes_of(setpoints, task.distance_counts < 0 ? -1.0L : 1.0L);
  const long double dt = static_cast<long double>(task.tick_s);
  const long double lsb = 1.0L / static_cast<long double>(kSignalPerCount);  // counts
  const long double slack = static_cast<long double>(stage_count + 1);
  const auto keeps = [&](long double peak, double limit, int order) {
    const long double allowed = static_cast<long double>(limit) * std::pow(dt, static_cast<long double>(order)) / lsb;
    return peak <= allowed + std::ldexp(slack, order - 1);
  };
  const auto per_second = [&](long double peak, int order) {
    const long double per_tick = peak * lsb / static_cast<long double>(task.counts_per_unit);
    return static_cast<double>(per_tick / std::pow(dt, static_cast<long double>(order)));
  };
  StreamFigures figures{};
  figures.peak_velocity = per_second(extremes.velocity, 1);
  figures.peak_acceleration = per_second(std::max(extremes.acceleration, extremes.deceleration), 2);
  figures.peak_jerk = per_second(extremes.jerk, 3);
  figures.within_limits = keeps(extremes.velocity, task.limits.velocity, 1) &&
                          keeps(extremes.acceleration, task.limits.acceleration, 2) &&
                          keeps(extremes.deceleration, task.limits.deceleration, 2) &&
                          (task.kind == ProfileKind::kTrapezoid || keeps(extremes.jerk, task.limits.larger_jerk(), 3));
  return figures;
}

Rest rest_of(const std::vector<Signal>& setpoints, const MoveTask& task, const ArmModes& arm) {
  SimulatedDrive drive = drive_for(task, arm, setpoints[0]);
  const size_t last = last_change(setpoints);
  for (size_t i = 1; i <= last; ++i) static_cast<void>(drive.exchange({setpoints[i], true}));
  const double finest = arm.empty() ? task.tick_s : 1.0 / (kSamplesPerPeriod * fastest_hz(arm));
  const double step_s = std::min(task.tick_s, finest);
  Rest rest{static_cast<double>(last) * task.tick_s, 0.0, drive.arm().released(step_s)};
  rest.residual_peak = free_peak(rest.arm, arm, step_s);
  return rest;
}

std::optional<double> settling_time_s(const Rest& rest, double threshold) {
  constexpr uint64_t kMostSamples = 2000000;
  Arm arm = rest.arm;
  uint64_t settled = 0;  // the sample after the last one above the threshold
  for (uint64_t i = 0; i < kMostSamples; ++i) {
    if (std::abs(arm.acceleration()) > threshold) settled = i + 1;
    if (arm.acceleration_envelope() <= threshold) return static_cast<double>(settled) * arm.step_s();
    arm.step(0.0);
  }
  return std::nullopt;
}

Comparison compare(const MoveTask& plain_task, Recording plain, const MoveTask& shaped_task, Recording shaped,
                   const ArmModes& arm, uint32_t stage_count, double settle_band) {
  Comparison result{};
  const Rest plain_rest = rest_of(plain.setpoints, plain_task, arm);
  const Rest shaped_rest = rest_of(shaped.setpoints, shaped_task, arm);
  const double threshold = settle_band * plain_rest.residual_peak;
  const auto figures = [threshold](const Rest& rest, const StreamFigures& stream) {
    MoveFigures line{rest.move_time_s, rest.residual_peak, sim::settling_time_s(rest, threshold), {}, stream};
    if (line.settling_time_s) line.total_time_s = line.move_time_s + *line.settling_time_s;
    return line;
  };
  result.plain_figures = figures(plain_rest, evaluate_stream(plain.setpoints, plain_task, 0));
  result.shaped_figures = figures(shaped_rest, evaluate_stream(shaped.setpoints, shaped_task, stage_count));
  const bool rings = plain_rest.residual_peak > 0.0;
  result.residual_ratio = rings ? shaped_rest.residual_peak / plain_rest.residual_peak : 0.0;
  result.within_limits = result.plain_figures.stream.within_limits && result.shaped_figures.stream.within_limits;
  result.zero_delay_met = shaped.report.zero_delay_met;
  result.plain = std::move(plain);
  result.shaped = std::move(shaped);
  return result;
}

}  // namespace stillpoint::sim
