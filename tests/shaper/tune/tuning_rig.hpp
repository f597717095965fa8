// SPDX-License-Identifier: Apache-2.0
// An axis with a tuner, and an arm behind a simulated drive: what a firmware's tick and background do, without one.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "shaper/axis/axis.hpp"
#include "shaper/tune/auto_tune.hpp"
#include "sim/simulated_drive.hpp"

namespace stillpoint::testing {

constexpr double kTuneTick = 1e-3;
constexpr double kTuneCounts = 1e6;  // a unit

// The paper's limits, counts.
inline AxisLimits paper_limits() {
  return {1.2 * kTuneCounts, 20.0 * kTuneCounts, 20.0 * kTuneCounts, 600.0 * kTuneCounts};
}

// A unit is a metre here. 100 ug/sqrt(Hz), as a cheap MEMS accelerometer has it, over half the tick rate; 16 bits over
// 16 g.
inline sim::SimulatedDriveConfig drive_config(const sim::ArmModes& arm, uint64_t seed) {
  constexpr double kG = 9.81;
  sim::SimulatedDriveConfig config{};
  config.modes = arm;
  config.tick_s = kTuneTick;
  config.counts_per_unit = kTuneCounts;
  config.encoder = {kSignalPerCount, 1.0, seed};
  config.accelerometer = {16.0 * kG / 32768.0, 16.0 * kG, 100e-6 * kG * 22.36, seed + 1};
  return config;
}

inline TuneConfig tune_config(int32_t distance_counts) {
  TuneConfig config{};
  config.move = Move{distance_counts, ProfileKind::kSCurve, paper_limits(), 0.0, false};
  config.amplitude_counts = 1e4;
  config.travel_counts = 2.0 * kTuneCounts;
  config.low_hz = 1.6;
  config.high_hz = 250.0;
  config.tolerance = 0.02;
  config.accept_by_itself = true;
  config.sensor_lowest = INT16_MIN;
  config.sensor_highest = INT16_MAX;
  return config;
}

class TuningRig {
 public:
  explicit TuningRig(const sim::ArmModes& arm, uint64_t seed = 1) : TuningRig(drive_config(arm, seed)) {}
  // `change` what is wanted of the axis.
  explicit TuningRig(const sim::SimulatedDriveConfig& config, const std::function<void(AxisConfig&)>& change = {})
      : axis(std::make_unique<Axis<2048>>()), memory(std::make_unique<TuneMemory>()), drive(config) {
    const AxisLimits& limits = paper_limits();
    AxisConfig of_axis{kTuneTick, limits, limits.acceleration, limits.jerk};
    if (change) change(of_axis);
    configured = axis->configure(of_axis);
    axis->reset(config.start);
    tune.begin(*axis, *memory);
    for (int i = 0; i < 4; ++i) tick();
  }

  void tick() {
    const Signal setpoint = axis->tick();
    const hal::ServoFeedback feedback = drive.exchange({setpoint, true});
    TuneSample sample{setpoint, feedback.position, feedback.acceleration, feedback.valid};
    if (on_sample) on_sample(sample);
    tune.tick(sample);
    if (on_tick) on_tick(setpoint);
  }

  void step() {
    tick();
    axis->service();
    tune.service({});
    const TuneState state = tune.report().state;
    if (states.empty() || states.back() != state) states.push_back(state);
  }

  // Until the tuning has ended, or waits for an answer. False where it does neither.
  bool run(uint32_t most_ticks = 100000) {
    for (uint32_t i = 0; i < most_ticks; ++i) {
      step();
      if (!tune.busy() || tune.report().state == TuneState::kProposed) return true;
    }
    return false;
  }

  std::unique_ptr<Axis<2048>> axis;
  std::unique_ptr<TuneMemory> memory;
  sim::SimulatedDrive drive;
  AutoTune tune;
  Status configured;
  std::vector<TuneState> states;
  std::function<void(TuneSample&)> on_sample;  // before the tuner has it
  std::function<void(Signal)> on_tick;
};

}  // namespace stillpoint::testing
