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

// Largest differences of the setpoints, LSB: along the move; from a start in motion, while the speed grows or falls.
struct Extremes {
  long double velocity;
  long double acceleration;
  long double deceleration;
  long double turning;  // of either sign, where the velocity turns round
  long double jerk;
};

struct Before {
  long double velocity;
  long double acceleration;
};

// As if the acceleration of the start had always been there.
Before before_start(const MoveTask& task) {
  const long double dt = static_cast<long double>(task.tick_s);
  const long double lsb = static_cast<long double>(kSignalPerCount);
  const long double acceleration = static_cast<long double>(task.start.acceleration) * dt * dt * lsb;
  return {static_cast<long double>(task.start.velocity) * dt * lsb - acceleration / 2.0L, acceleration};
}

void raise(long double& peak, long double value) { peak = std::max(peak, value); }

// The limits that a move keeps that begins beyond them: its start's own, and the velocity that letting go of its
// acceleration leads to.
AxisLimits kept_limits(const MoveTask& task) {
  AxisLimits limits = task.limits;
  if (task.from_rest()) return limits;
  const double v = task.start.velocity;
  const double a = task.start.acceleration;
  const double let_go = v + a * std::abs(a) / (2.0 * limits.jerk);
  limits.velocity = std::max({limits.velocity, std::abs(v), std::abs(let_go)});
  const double strongest = std::max(limits.acceleration, limits.deceleration);
  if (std::abs(a) > strongest) limits.acceleration = limits.deceleration = std::abs(a);
  double& own = a * v < 0.0 ? limits.deceleration : limits.acceleration;
  own = std::max(own, std::abs(a));
  return limits;
}

// Two steps keep their sign for sure between them where neither is less than an acceleration may make of it.
void raise_acceleration(Extremes& extremes, long double before, long double step, long double larger_limit) {
  const long double change = step - before;
  const bool turns = (step > 0.0L) != (before > 0.0L) || std::min(std::abs(step), std::abs(before)) < larger_limit;
  if (turns) return raise(extremes.turning, std::abs(change));
  raise((change > 0.0L) == (step > 0.0L) ? extremes.acceleration : extremes.deceleration, std::abs(change));
}

// Long double holds a Signal exactly, and, unlike int64_t, the difference of any two.
Extremes extremes_of(const std::vector<Signal>& setpoints, const MoveTask& task, const AxisLimits& limits) {
  Extremes extremes{};
  const double larger = std::max(limits.acceleration, limits.deceleration) * task.tick_s * task.tick_s;
  const long double larger_limit = static_cast<long double>(larger) * static_cast<long double>(kSignalPerCount);
  const long double direction = task.distance_counts < 0 ? -1.0L : 1.0L;
  const Before start = before_start(task);
  long double position = static_cast<long double>(setpoints[0]);
  long double velocity = direction * start.velocity;
  long double acceleration = direction * start.acceleration;
  for (size_t i = 1; i < setpoints.size() + 3; ++i) {
    const long double next = static_cast<long double>(setpoints[std::min(i, setpoints.size() - 1)]);
    const long double step = direction * (next - position);
    const long double change = step - velocity;
    raise(extremes.velocity, std::abs(step));
    if (task.from_rest()) {
      raise(extremes.acceleration, change);
      raise(extremes.deceleration, -change);
    } else {
      raise_acceleration(extremes, velocity, step, larger_limit);
    }
    raise(extremes.jerk, std::abs(change - acceleration));
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
  const AxisLimits limits = kept_limits(task);
  const Extremes extremes = extremes_of(setpoints, task, limits);
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
  figures.peak_acceleration = per_second(std::max({extremes.acceleration, extremes.deceleration, extremes.turning}), 2);
  figures.peak_jerk = per_second(extremes.jerk, 3);
  figures.within_limits = keeps(extremes.velocity, limits.velocity, 1) &&
                          keeps(extremes.acceleration, limits.acceleration, 2) &&
                          keeps(extremes.deceleration, limits.deceleration, 2) &&
                          keeps(extremes.turning, std::max(limits.acceleration, limits.deceleration), 2) &&
                          (!task.profile.jerk_limited() || keeps(extremes.jerk, limits.larger_jerk(), 3));
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
