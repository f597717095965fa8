// SPDX-License-Identifier: Apache-2.0
// The auto-tune of a drive that has none: the same tuner, here, of what the drive's scope records.
#pragma once

#include <functional>
#include <vector>

#include "shaper/tune/auto_tune.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

struct HostTuneTask {
  TuneRegisters registers;  // its excitation: auto and move are the same here
  bool propose;             // ends with the proposal, nothing kept
  // Before anything moves, and some times a second from then on; what they throw ends it.
  std::function<void(const Announcement&)> announced;
  std::function<void(double part_done)> meanwhile;
};

struct HostTuning {
  // As AutoTune has it, in counts and raw steps, amplitudes of the modes over the strongest one's; kProposed where it
  // ended there. Of the flaws the gaps are the ticks without feedback that the drive counted while it recorded.
  TuneReport report;
  std::vector<sim::SpecifiedShaper> shapers;  // once they are kept
};

// Refuses the excitations that the host does not have.
void check_host_can(const TuneRegisters& registers);

// Of a drive that is enabled. AutoTune runs on this host, beside an axis with the drive's limits, in a time of its own:
// where that moves, the drive makes the move and its scope records the rest after it (trigger 4), which is then told to
// the tuner tick by tick. So the plan, the announcement, what is found, chosen, kept and undone are AutoTune's. Other
// than on the drive:
//  - one channel is all that holds a record of the band. Where the accelerometer is listened to, a move out and back
//    comes first, of which both sensors are recorded for half a second: whether there is one, and when the motor
//    stands. That is taken for the same after the other moves.
//  - a sample is the last of its ticks, no mean; 1792 of them, not 2048; the following error in whole counts.
//  - a bump, a sine and a chirp cannot be had by set-points: refused by the option's name.
// Throws a Refusal, the shaper of before in force again (in a fault: once that is reset) and the axis at rest. Mode and
// move duration are as they were at the end; target and the settings of the scope are not.
HostTuning tune_by_host(sim::RegisterPort& port, const HostTuneTask& task);

}  // namespace stillpoint::cli
