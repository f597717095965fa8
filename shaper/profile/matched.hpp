// SPDX-License-Identifier: Apache-2.0
// An S-curve whose segments are fitted to a mode, so that the profile alone leaves it still. Background context.
//
// With h half a damped period and K = exp(-pi zeta / sqrt(1 - zeta^2)), whatever is followed by K times itself h later
// leaves nothing of the mode. So every matched move is (base(t) + K base(t - h)) / (1 + K), the base an S-curve; what
// makes it shorter than shaping one is that a box of the base, a stretch of constant jerk, acceleration or velocity,
// lasts just h: then the two follow each other instead of adding up, and the level may be (1 + K) times as high.
//
//   kRamps     each ramp is a box of h times a box of x: whichever is the longer is its constant acceleration, the
//              other its constant jerk. Levels 1 and K.
//   kVelocity  the velocity is a box of h, with ramps between its levels V and K V: short moves.
//   kShifted   any base, shaped: where no box is worth its length.
//
// Of the first two also with n h and K^n: n odd, or any n where the mode is undamped (n = 2: a box of a period).
#pragma once

#include "shaper/base/status.hpp"
#include "shaper/profile/limits.hpp"
#include "shaper/profile/plan.hpp"

namespace stillpoint {

// The shortest of the three within the limits, as plan_rest_to_rest does it for kMatched, other arguments checked.
// The optimum is the least over the form and the peak velocity, by a scan of 16 and golden sections. A ramp's boxes
// last 1/1024 of a tick at least.
// Refuses a frequency not finite, not above zero or above half the tick's rate, a damping ratio outside [0, 1), a move
// of more than kMaxDurationTicks. Cost: some 500 evaluations of a pair of ramps.
Status plan_matched(double distance, const AxisLimits& limits, double tick_s, const ProfileDetail& detail, Plan& out);

// Writes the segments of `plan.matched` over a duration above 0. Longer than the optimum each keeps its match, and its
// limits: kRamps cruises longer, kVelocity and kShifted slow down their ramps or their base (kVelocity stands early
// where slower ramps would overlap at a higher jerk). Shorter, all of it is sped up, and the mode it leaves still too.
void write_matched(Plan& plan, uint32_t duration_ticks);

}  // namespace stillpoint
