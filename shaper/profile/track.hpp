// SPDX-License-Identifier: Apache-2.0
// A plan made ready for the tick: the move as integers, sampled by adding.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/base/wide.hpp"
#include "shaper/profile/plan.hpp"

namespace stillpoint {

// Fraction bits of a track's numbers. A jerk rounded at the 97th bit errs by 2^-40 counts after 1e6 ticks (n^3/6 times
// the rounding), far below the 2^-32 of the signal; 31 bits and a sign are left for the position.
constexpr int kTrackFractionBits = 96;

// Position and its forward differences at a tick: difference[0] is the position in counts, difference[k] its k-th.
struct Differences {
  Wide difference[4];
};

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
  Signal start;
  Signal target;
  uint32_t duration_ticks;
  uint32_t switch_count;
  Switch switches[kMaxSwitches];  // ticks rise

  // Background. The plan's position unit is the count, and its distance target - start to within a few ulp. What the
  // rounding of the plan's doubles leaves between its end and the target is measured exactly and taken out by a
  // change of jerk over the whole move, 1e-15 of the plan's own jerk.
  static void make(const Plan& plan, Signal start, Signal target, Track& out);

  // The plan as it is, ending where its own numbers lead: what `make` begins with. The target is the sample at the end.
  static void make_uncorrected(const Plan& plan, Signal start, Track& out);

  // The state that `tick` ticks of adding lead to (without the last snap to the target), and which switch comes next.
  Differences differences_at(uint32_t tick, uint32_t& next_switch) const;
};

// Walks along a track. Tick context: additions only; 3 of 128 bits a tick, 4 more where a segment begins.
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

 private:
  void add_switch();

  const Track* track_ = nullptr;
  uint32_t tick_ = 0;
  uint32_t next_switch_ = 0;
  Signal position_ = 0;
  Differences state_ = {};
};

}  // namespace stillpoint
