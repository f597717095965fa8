// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/base/status.hpp"

namespace stillpoint {

// Limits of a stop, made ready for the tick: accelerations step on a lattice of `jerk_step`, of which the
// deceleration limit is a whole multiple, so that the tick needs only to add and compare.
struct StopLimits {
  int64_t deceleration;  // LSB/tick^2, levels * jerk_step
  int64_t jerk_step;     // LSB/tick^3

  // Background. `deceleration` in counts/s^2 and `jerk` in counts/s^3, both above zero.
  static Status make(double deceleration, double jerk, double tick_s, StopLimits& out);
};

// Brings a moving output to rest from whatever velocity and acceleration it has, beginning with the next tick.
// Tick context; additions, comparisons and, once, a multiplication. The third difference of what it emits is within
// jerk_step, the second within the larger of the deceleration limit and what it was at the start; it turns round only
// where the acceleration it was given cannot be let go in time.
//
// The rule: braking moves on levels m * jerk_step. In each tick the highest of the three levels in reach is taken from
// which the velocity still left can be let go level by level, sum(i * jerk_step, i < m); what remains below one step
// goes in the last tick. At the end of the position range it stands.
class StopRamp {
 public:
  // From the last three outputs, newest first.
  void start(const StopLimits& limits, Signal newest, Signal before, Signal before_that);
  Signal tick();
  bool at_rest() const { return velocity_ == 0 && acceleration_ == 0; }

 private:
  int64_t next_braking(int64_t velocity, int64_t braking);
  int64_t align(int64_t velocity, int64_t braking);

  StopLimits limits_ = {};
  Signal position_ = 0;
  int64_t velocity_ = 0;      // LSB/tick
  int64_t acceleration_ = 0;  // LSB/tick^2
  int64_t level_ = 0;         // braking over jerk_step; below 0: not on a level
  int64_t release_ = 0;       // sum of the levels below
};

}  // namespace stillpoint
