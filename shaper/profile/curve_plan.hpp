// SPDX-License-Identifier: Apache-2.0
// The shortest move of a given shape: sine ramps, a polynomial, a table. Background context.
#pragma once

#include "shaper/base/status.hpp"
#include "shaper/profile/limits.hpp"
#include "shaper/profile/plan.hpp"

namespace stillpoint {

// What plan_rest_to_rest does for kSin2, kPoly5, kPoly7 and kTable, the other arguments checked, distance not zero.
//
// kSin2: from rest to the velocity V over a ramp of V sin^2(pi t / 2T), T = max(pi V / 2A, pi sqrt(V / 2J)), cruise,
// and back, each ramp by its own acceleration and jerk limit. The rest: one piece from end to end, as long as the first
// of the table's peaks that meets its limit makes it, T^n = peak D / limit; of two jerk limits, the smaller.
// Refuses what kTable's table is refused for, and a move of more than kMaxDurationTicks. Cost: at most 64 Newton steps.
Status plan_curve(double distance, const AxisLimits& limits, ProfileKind kind, double tick_s,
                  const ProfileDetail& detail, Plan& out);

// Over a plan of curve pieces, unit/tick^n.
Peaks curve_peaks(const Plan& plan);

}  // namespace stillpoint
