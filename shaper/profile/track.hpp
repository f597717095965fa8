// SPDX-License-Identifier: Apache-2.0
// A plan made ready for the tick: the move as integers, sampled by adding.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/base/wide.hpp"
#include "shaper/profile/curve.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/profile/plan_from.hpp"

namespace stillpoint {

// Fraction bits of a track's numbers. A jerk rounded at the 97th bit errs by 2^-40 counts after 1e6 ticks (n^3/6 times
// the rounding), far below the 2^-32 of the signal; 31 bits and a sign are left for the position.
constexpr int kTrackFractionBits = 96;

// Position and its forward differences at a tick: difference[0] is the position in counts, difference[k] its k-th.
struct Differences {
  Wide difference[4];
};

// Standing at `position`.
constexpr Differences standing(Signal position) { return Differences{{Wide{0, static_cast<uint64_t>(position)}}}; }

// To the nearest LSB, halves up.
constexpr Signal signal_of(const Differences& state) {
  return static_cast<Signal>(state.difference[0].high + (state.difference[0].low >> 63));
}

// What is added to the differences when the plan's next segment begins. The segment may begin between two ticks: a
// change of jerk dj at time t adds dj (n - t)^3 / 6 to the samples from tick ceil(t) on, which is a cubic and so has
// exactly these differences. Every tick of the stream is thus a sample of the continuous plan, and by the mean value
// theorem each of its differences keeps the limit of the derivative.
struct Switch {
  uint32_t tick;
  Differences add;
};

constexpr size_t kMaxSwitches = kMaxSegments + 3;

struct Track {
  Differences start;
  Differences end;  // position and velocity at and after the last tick; the velocity is 0 for a move to rest
  uint32_t duration_ticks;
  uint32_t switch_count;
  uint32_t part_count;  // not 0: a curve, whose parts lie where the switches would
  union {
    Switch switches[kMaxSwitches];  // ticks rise
    CurvePart parts[kMaxPieces];
  };

  bool is_curve() const { return part_count != 0; }

  // All of these: background. The plan's position unit is the count.

  // From `start` to rest at `target`; the plan's distance is target - start to within a few ulp. What the rounding of
  // the plan's doubles leaves between its end and the target is measured exactly and taken out by a change of jerk over
  // the whole move, 1e-15 of the plan's own jerk. The plan begins with its own start velocity.
  static void make(const Plan& plan, Signal start, Signal target, Track& out);

  // The same from where another track is at a tick: the plan's start velocity and acceleration are those of `start`
  // (see motion_of), whose own numbers go on, so that nothing but the jerk changes there.
  static void make_from(const Plan& plan, const Differences& start, Signal target, Track& out);

  // To the velocity that the plan ends at, `velocity` counts/tick, and on at it for ever.
  static void make_cruise(const Plan& plan, const Differences& start, double velocity, Track& out);

  // The plan as it is, ending where its own numbers lead: what `make` begins with. Of segments only.
  static void make_uncorrected(const Plan& plan, Signal start, Track& out);

  Signal target() const { return static_cast<Signal>(end.difference[0].high); }
  bool cruises() const { return end.difference[1] != Wide{0, 0}; }

  // The state that `tick` ticks lead to, what begins at that tick included, and which switch comes next. From the last
  // tick on: the end, moved on at its velocity. On a curve those of its value, velocity and acceleration there.
  Differences differences_at(uint64_t tick, uint32_t& next_switch) const;
};

// Velocity and acceleration there, in counts and seconds.
StartMotion motion_of(const Differences& state, double tick_s);

// Walks along a track. Tick context: additions only; 3 of 128 bits a tick, 4 more where a segment begins; on a curve
// see CurveWalk. Positions wrap at the end of their range.
class Sampler {
 public:
  // Stands at `position`.
  void rest_at(Signal position);
  // Takes up the track at its start; the first `tick` returns the sample of tick 1. `track` must outlive the move.
  void begin(const Track& track);
  // The same some way in, as if it had been ticked `tick` times. Background: exact, but in multiplications.
  void begin_at(const Track& track, uint32_t tick);

  Signal tick();
  Signal position() const { return position_; }
  bool at_rest() const { return track_ == nullptr; }
  // Ticks since the track's start; stays at its last one.
  uint32_t ticks() const { return tick_; }

 private:
  void add_switch();
  void end();

  const Track* track_ = nullptr;
  uint32_t tick_ = 0;
  uint32_t next_switch_ = 0;
  Signal position_ = 0;
  Differences state_ = {};
  CurveWalk walk_;  // on a curve, until its end
};

}  // namespace stillpoint
