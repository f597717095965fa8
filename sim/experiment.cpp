// SPDX-License-Identifier: Apache-2.0
#include "sim/experiment.hpp"

#include <algorithm>
#include <memory>

#include "shaper/axis/axis.hpp"
#include "shaper/axis/still_plan.hpp"
#include "shaper/profile/track.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

constexpr size_t kLineCapacity = size_t{1} << 17;  // two ZVDs of 0.02 Hz at a millisecond
constexpr size_t kTicksBetweenReports = size_t{1} << 18;
using HostAxis = Axis<kLineCapacity>;

void check_length(uint32_t ticks, double tick_s) {
  if (ticks <= kMostRecordedTicks) return;
  throw bad_argument("duration", shortest(ticks * tick_s),
                     "longer than is recorded, at most " + shortest(kMostRecordedTicks * tick_s) + " s is accepted");
}

}  // namespace

AxisConfig axis_config_of(const MoveTask& task) {
  const double per_tick = 1.0 / task.tick_s;
  return AxisConfig{task.tick_s, task.limits, per_tick * per_tick, per_tick * per_tick * per_tick};
}

Move move_of(const MoveTask& task) {
  return Move{task.distance_counts, task.profile.kind, task.limits,
              task.duration_s,      task.zero_delay,   task.profile.detail};
}

Recording run_axis(const MoveTask& task, const ShaperDesign& design, const OnProgress& on_progress) {
  const auto axis = std::make_unique<HostAxis>();
  require(axis->configure(axis_config_of(task)), task.counts_per_unit);
  axis->reset(0);
  require(axis->set_shaper(design));
  static_cast<void>(axis->tick());
  Recording recording{};
  require(axis->command(move_of(task), &recording.report), task.counts_per_unit);
  const uint32_t total = recording.report.total_ticks;
  check_length(total, task.tick_s);
  recording.setpoints.reserve(total + 2U);
  recording.setpoints.push_back(0);
  do {
    recording.setpoints.push_back(axis->tick());
    const size_t ticks = recording.setpoints.size();
    if (on_progress && ticks % kTicksBetweenReports == 0) on_progress(static_cast<double>(ticks) / total);
  } while (axis->state().phase != AxisPhase::kAtRest || axis->pending());
  return recording;
}

Plan plan_of(const MoveTask& task, uint32_t duration_ticks) {
  Plan plan{};
  if (!task.from_rest()) {
    require(plan_from(task.start, task.distance_counts, task.limits, task.tick_s, plan), task.counts_per_unit);
    return plan;
  }
  require(
      plan_rest_to_rest(task.distance_counts, task.limits, task.profile.kind, task.tick_s, plan, task.profile.detail),
      task.counts_per_unit);
  if (plan.duration_ticks != 0 && duration_ticks != 0) require(stretch(plan, duration_ticks), task.counts_per_unit);
  return plan;
}

Recording run_from_motion(const MoveTask& task) {
  const Plan plan = plan_of(task);
  check_length(plan.duration_ticks, task.tick_s);
  Track track{};
  Track::make(plan, 0, signal_from_counts(task.distance_counts), track);
  Sampler sampler;
  sampler.begin(track);
  Recording recording{{plan.duration_ticks, plan.duration_ticks, plan.optimum_ticks, true}, {0}};
  for (uint32_t tick = 0; tick < plan.duration_ticks; ++tick) recording.setpoints.push_back(sampler.tick());
  return recording;
}

Recording run_still(const MoveTask& task, const std::vector<Mode>& modes) {
  Plan plan{};
  require(plan_still(task.distance_counts, task.limits, modes.data(), modes.size(), task.tick_s, plan),
          task.counts_per_unit);
  check_length(plan.duration_ticks, task.tick_s);
  Track track{};
  Track::make(plan, 0, signal_from_counts(task.distance_counts), track);
  Recording recording{};
  recording.report.profile_ticks = plan.duration_ticks;
  recording.report.total_ticks = plan.duration_ticks;
  recording.report.optimum_ticks = plan.optimum_ticks;
  recording.report.peaks = peaks_of(plan, task.tick_s);
  recording.setpoints.push_back(0);
  Sampler sampler;
  sampler.begin(track);
  for (uint32_t i = 0; i < plan.duration_ticks; ++i) recording.setpoints.push_back(sampler.tick());
  return recording;
}

SimulatedDrive drive_for(const MoveTask& task, const ArmModes& arm, Signal start) {
  SimulatedDriveConfig config{};
  config.modes = arm;
  config.tick_s = task.tick_s;
  config.counts_per_unit = task.counts_per_unit;
  config.start = start;
  return SimulatedDrive(config);
}

ArmTrace simulate_arm(const std::vector<Signal>& setpoints, const MoveTask& task, const ArmModes& arm, size_t ticks) {
  SimulatedDrive drive = drive_for(task, arm, setpoints[0]);
  ArmTrace trace;
  for (size_t i = 0; i < ticks; ++i) {
    if (i > 0) static_cast<void>(drive.exchange({setpoints[std::min(i, setpoints.size() - 1)], true}));
    trace.motor.push_back(drive.motor_position());
    trace.tip.push_back(drive.tip_position());
    trace.acceleration.push_back(drive.tip_acceleration());
  }
  return trace;
}

}  // namespace stillpoint::sim
