// SPDX-License-Identifier: Apache-2.0
// Moves of an Axis on a simulated arm.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "shaper/axis/axis_config.hpp"
#include "shaper/base/signal.hpp"
#include "shaper/profile/plan_from.hpp"
#include "shaper/shaping/design.hpp"
#include "sim/plant/arm.hpp"
#include "sim/profile_kind.hpp"
#include "sim/simulated_drive.hpp"

namespace stillpoint::sim {

// A move from zero to rest. Units: counts and seconds.
struct MoveTask {
  double tick_s = 1e-3;
  double counts_per_unit = 1e6;
  int32_t distance_counts = 0;
  SpecifiedProfile profile = {};
  AxisLimits limits = {};   // counts/s^n
  double duration_s = 0.0;  // as Move::duration_s
  bool zero_delay = false;
  StartMotion start = {0.0, 0.0};  // an s-curve may begin in motion

  bool from_rest() const { return start.velocity == 0.0 && start.acceleration == 0.0; }
};

// An axis for that move alone. It must have quick-stop limits, which no experiment here uses: a count a tick^2, a
// tick^3, valid at any tick.
AxisConfig axis_config_of(const MoveTask& task);
Move move_of(const MoveTask& task);

// What an axis emitted. setpoints[0] is where it stood; setpoints[k] is what tick k returned. The last one stands.
struct Recording {
  MoveReport report;
  std::vector<Signal> setpoints;
};

// Told now and then how much of a long work is done, 0..1. May be empty.
using OnProgress = std::function<void(double)>;

// Longest move that is recorded: every tick is kept, and looked at several times over.
constexpr uint32_t kMostRecordedTicks = 20000000;

// Runs the move, which is from rest, through an Axis of its own. Throws a Refusal where the axis refuses or the
// recording would be too long.
Recording run_axis(const MoveTask& task, const ShaperDesign& design, const OnProgress& on_progress = {});

// The plan behind a move: as run_axis emits it where that took `duration_ticks`; from a start in motion as it is, in
// the least time. Throws a Refusal.
Plan plan_of(const MoveTask& task, uint32_t duration_ticks = 0);

// The samples of a move that begins in motion, without an axis. Throws a Refusal.
Recording run_from_motion(const MoveTask& task);

// The profile that leaves the modes still by itself (plan_still), sampled by a track, as an axis would. Throws a
// Refusal where there is none, or it would be too long.
Recording run_still(const MoveTask& task, const std::vector<Mode>& modes);

// A drive at rest at `start` with that arm behind it; a perfect encoder.
SimulatedDrive drive_for(const MoveTask& task, const ArmModes& arm, Signal start);

// What the arm did behind a drive that was given the setpoints; values at the ticks, in units.
struct ArmTrace {
  std::vector<double> motor;
  std::vector<double> tip;
  std::vector<double> acceleration;  // of the tip
};
// `ticks` of them; past the end of `setpoints` the last is held.
ArmTrace simulate_arm(const std::vector<Signal>& setpoints, const MoveTask& task, const ArmModes& arm, size_t ticks);

}  // namespace stillpoint::sim
