// SPDX-License-Identifier: Apache-2.0
// An axis that tunes itself on a simulated drive, as the firmware has it: AutoTune beside AxisCore.
#pragma once

#include <cstdint>
#include <vector>

#include "shaper/tune/auto_tune.hpp"
#include "sim/experiment.hpp"
#include "sim/simulated_drive.hpp"

namespace stillpoint::sim {

// Units: counts and seconds.
struct TuneTask {
  MoveTask move;  // excites, and back to where it began verifies, then with its zero delay where that can be
  TuneExcitation excitation = TuneExcitation::kAuto;
  TuneSource source = TuneSource::kAuto;
  double amplitude_counts = 0.0;
  double travel_counts = 0.0;
  double low_hz = 0.0;
  double high_hz = 0.0;
  double tolerance = 0.0;
  SimulatedDriveConfig drive;
};

// What a drive was told, did and sensed in a tick.
struct TuneTick {
  TuneState state;
  Signal setpoint;
  double tip;               // units
  double tip_acceleration;  // unit/s^2, true
  Signal position;          // as read
  int32_t acceleration;     // as read, raw
};

struct Tuning {
  TuneReport report;             // as it ended
  Announcement first_announced;  // before anything moved
  std::vector<TuneTick> ticks;   // from where the drive is enabled
  // What was identified from, if anything was: raw readings, or counts that the motor is ahead of its setpoint.
  std::vector<float> record;
  double record_rate_hz;
  double record_begins_s;
};

// Raw, where it saturates.
int32_t highest_reading(const AccelerometerConfig& sensor);

// The words that people write for them.
const char* text(TuneExcitation excitation);
const char* text(TuneSource source);

// Runs it to its end; what is found is accepted. Throws a Refusal where the axis or the tuner refuses, or it does not
// end.
Tuning tune_on_drive(const TuneTask& task, const OnProgress& on_progress = {});

}  // namespace stillpoint::sim
