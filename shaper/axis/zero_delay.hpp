// SPDX-License-Identifier: Apache-2.0
// Zero-delay shaping (Li 2017, section 3): the profile is sped up uniformly so that the *shaped* move ends in time.
// Speeding up raises velocity, acceleration and jerk of the profile; a shaper of positive taps can only lower them. So
// the limits are checked where they are promised: on the shaped stream.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/profile/limits.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/profile/track.hpp"
#include "shaper/shaping/shaper.hpp"

namespace stillpoint {

// A profile that takes longer than this within its own limits is not sped up beyond them: there is next to nothing to
// win (a shaper's length in eight seconds), and the work of finding out stays bounded.
constexpr uint32_t kLongestSearchTicks = UINT32_C(1) << 13;

// The limit that a plan at its least duration, sped up at all, breaks behind a shaper of `length_ticks` for certain:
// one that it stays at for longer than the shaper is, so that the shaped stream gets there too. kNone if there is none.
Quantity sustained_limit(const Plan& plan, uint32_t length_ticks);

// Runs moves from `start` to `target` through a copy of a shaper, tick by tick as the axis would. Background.
class ShapedMoveCheck {
 public:
  // `scratch` and `track` are overwritten; the shaper's lines go to the memory it was configured with.
  ShapedMoveCheck(const AxisLimits& limits, bool jerk_limited, double tick_s, Shaper& scratch, Track& track,
                  Signal start, Signal target);

  // The first limit that the shaped stream breaks; kNone if it keeps all. `plan` in counts, over the whole distance.
  // Cost: the plan's ticks and the length of the shaper, in stage ticks.
  Quantity broken(const Plan& plan);
  // The same for the plan slowed down or sped up uniformly. kDuration where it cannot be.
  Quantity broken_at(const Plan& plan, uint32_t profile_ticks);

  // Of the last stream that kept all limits: its peaks in counts/s^n, and the largest part that one of them is of its
  // limit.
  const Peaks& peaks() const { return peaks_; }
  double use() const { return use_; }
  uint32_t length_ticks() const { return scratch_.length_ticks(); }

  // The least duration in (too_short, enough] whose shaped stream keeps the limits, given that `enough` does: by
  // bisection, so at most 13 checks for `enough` up to kLongestSearchTicks; beyond, `enough` itself. The limit that
  // binds just below it comes back in `binding`.
  uint32_t least_ticks(const Plan& plan, uint32_t too_short, uint32_t enough, Quantity& binding);

  // The least duration in [from, enough], given that `enough` keeps the limits, for a shaper that raises peaks: by
  // bisection up to kLongestSearchTicks; beyond, the first of a few durations from 1 % to 70 % longer, or `enough`.
  uint32_t least_slowed_ticks(const Plan& plan, uint32_t from, uint32_t enough);

 private:
  struct Extremes {
    int64_t velocity;      // magnitude
    int64_t acceleration;  // along the move
    int64_t deceleration;
    double jerk;  // magnitude
  };
  void note(const Extremes& extremes);

  Shaper& scratch_;
  Track& track_;
  Signal start_;
  Signal target_;
  double tick_s_;
  double limit_[4];  // velocity, acceleration, deceleration, jerk along the move, LSB/tick^n with its allowance
  Peaks peaks_ = {};
  double use_ = 0.0;
};

}  // namespace stillpoint
