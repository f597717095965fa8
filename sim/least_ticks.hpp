// SPDX-License-Identifier: Apache-2.0
// What no command can beat: the least ticks to arrive within the limits and leave the modes still.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shaper/profile/limits.hpp"
#include "shaper/shaping/mode.hpp"
#include "sim/experiment.hpp"

namespace stillpoint::sim {

struct LeastTicksQuestion {
  double distance;          // above 0, any unit
  AxisLimits limits;        // of the stream's differences; the larger of the two jerks on all of it
  std::vector<Mode> modes;  // at rest at the end: zeros at their sampled poles (reference, 3)
  double tick_s;
};

// Longer moves are not asked about: the programme grows with them.
constexpr uint32_t kMostLeastTicks = 4096;

// The farthest that a stream of `ticks` setpoints, at rest before and after, can go; its setpoints after each tick in
// `setpoints`, unless null. A linear programme over the velocities, one a tick.
double farthest(const LeastTicksQuestion& question, uint32_t ticks, std::vector<double>* setpoints = nullptr);

// Bisection on the ticks: whoever can go far can go less far, all scaled down. `known`: ticks in which the move is
// known to be possible. Nothing where that is above kMostLeastTicks. About ten programmes.
std::optional<uint32_t> least_ticks(const LeastTicksQuestion& question, uint32_t known,
                                    const OnProgress& on_progress = {});

}  // namespace stillpoint::sim
