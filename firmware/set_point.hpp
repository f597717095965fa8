// SPDX-License-Identifier: Apache-2.0
// From the registers of a profile-position set-point to a Move, and from the axis's refusal back to registers.
#pragma once

#include "firmware/parameters.hpp"
#include "shaper/axis/axis_config.hpp"

namespace stillpoint::firmware {

// The staged profile's limits.
AxisLimits profile_limits(const Parameters& parameters);

// The staged move. Relative: from `from`, where the axis stands or in flight is bound for, to the nearest count.
// Refuses a relative target outside the position range; `out` is then unchanged. Background.
Status make_move(const Parameters& parameters, bool relative, Signal from, Move& out);

// Registers 0012, 0013, 0016 from a refusal of the move. Where a shorter duration was asked for than the limits allow,
// 0013 names the duration and 0016 has the least one in ms; the limit that binds is in the reason's low byte.
void note_move_refusal(const Status& status, Parameters& parameters);

void note_velocity_refusal(const Status& status, Parameters& parameters);
void note_move_report(const MoveReport& report, Parameters& parameters);

}  // namespace stillpoint::firmware
