// SPDX-License-Identifier: Apache-2.0
// How fast something may close a gap and yet stop at its end.
#pragma once

#include <stdint.h>

namespace stillpoint {

// Braking at a constant level, let go at a constant jerk so that velocity, braking and gap come to zero together: in
// ticks, with the braking on whole multiples of the jerk J and m ticks before the end,
//   braking (m + 1) J,   velocity J m (m + 1) / 2,   gap before the tick J m (m + 1) (m + 2) / 6,
// linear between those; and beyond the gap where the braking reaches its level B, velocity^2 grows by 2B a gap.
// It asks for a part of the limits only, for what follows it needs the rest: at most 15/16 of the braking and half of
// the jerk.
class ApproachCurve {
 public:
  struct Point {
    int64_t velocity;  // after this tick
    int64_t braking;   // in this tick
  };

  // Background. For speeds up to `velocity`, at most kMaxVelocity; `braking` at least 2, `jerk` at least 2.
  static ApproachCurve make(int64_t velocity, int64_t braking, int64_t jerk);

  // For a gap >= 0 before the tick. Tick context: a search by bits for m, at most 20 turns, and two divisions by
  // shifting, or a square root of 31 turns.
  Point at(int64_t gap) const;

  int64_t jerk() const { return jerk_; }
  int64_t braking() const { return braking_; }

  static constexpr int64_t kMaxVelocity = INT64_C(1) << 56;

 private:
  Point near_end(int64_t gap) const;
  Point while_braking(int64_t gap) const;

  int64_t jerk_;
  int64_t braking_;  // levels_ * jerk_
  uint32_t levels_;
  int shift_;              // velocities lose so many bits before they are squared
  int64_t near_gap_;       // where the braking reaches its level,
  int64_t near_velocity_;  // and the velocity there
  int64_t far_gap_;        // from here on the curve is above all that its user can reach
};

}  // namespace stillpoint
