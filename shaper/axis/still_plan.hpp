// SPDX-License-Identifier: Apache-2.0
// The fastest profile that leaves a mode still by itself, without a shaper.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/axis/still_search.hpp"
#include "shaper/base/status.hpp"
#include "shaper/profile/limits.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/shaping/mode.hpp"

namespace stillpoint {

// Plans from rest to rest over `distance` in a time that is locally the least, so that the modes stand when the stream
// does: its velocities have a zero at each sampled pole (reference, 3). A fast move needs few ticks more for that than
// the plain one; where a shaper smooths all of it, this adds a swing of the acceleration or two at the places where
// they cost least.
//
// How: by the maximum principle the jerk is at a limit or the acceleration, or the velocity, is. So the move is a
// sequence of jerks +, 0, -, 0, +, ... of unknown lengths, most of them zero in the end. Acceleration at each change is
// linear in the lengths; velocity, distance and what the modes are left with are made so about the last guess: a linear
// programme a step (SmallLp), within a trust region. It begins at the plain S-curve, written into the sequence in
// kStillStarts ways, and the shortest of what they lead to counts: a good move, not one that is proved to be the best.
//
// The smaller of the two jerks holds on all of it. Duration: T = optimum_ticks, rounded up to whole ticks, the rest of
// the last standing. Refuses what plan_rest_to_rest does; kNotAvailable without a mode, with more than kMostStillModes,
// with an invalid one, and where no start led to a move that keeps everything to 1e-9. `out` is then unchanged.
// Cost: kStillStarts searches of at most StillSearch::kMostProgrammes programmes each; 8 ms in the mean on an x86-64
// host, so seconds where doubles are software. Stack: 16 KB. Background.
Status plan_still(double distance, const AxisLimits& limits, const Mode* modes, size_t mode_count, double tick_s,
                  Plan& out);

constexpr int kStillStarts = 7;

}  // namespace stillpoint
