// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/base/status.hpp"

namespace stillpoint {

// Limits of a stop, made ready for the tick: in whole LSB, up to one more than the limits given, so that a stop is
// never slower than they allow.
struct StopLimits {
  int64_t deceleration;  // LSB/tick^2
  int64_t jerk;          // LSB/tick^3

  // Background. `deceleration` in counts/s^2 and `jerk` in counts/s^3; refuses what limit_in_lsb refuses and a tick not
  // above zero, and leaves `out`. Above 2^62 LSB they count as that.
  static Status make(double deceleration, double jerk, double tick_s, StopLimits& out);
};

// Brings a moving output to rest from whatever velocity and acceleration it has, beginning with the next tick, in the
// fewest ticks that the limits allow; see braking.hpp for the rule. The third difference of what it emits is within the
// jerk, the second within the larger of the deceleration and what it was at the start. From outside the deceleration
// limit the acceleration is let go at the jerk limit first. It turns round only where the acceleration it was given
// cannot be let go in time. Positions wrap at the end of their range.
//
// Against the continuous optimum, which may change its jerk between ticks: less than a tick more, whatever the state.
// From any state: a velocity or acceleration past 2^62 LSB, a quarter of the position range in one tick, counts as
// that.
//
// Tick context; additions, comparisons and two divisions by shifting, see braking.hpp for the cost.
class StopRamp {
 public:
  // From the last three outputs, newest first.
  void start(const StopLimits& limits, Signal newest, Signal before, Signal before_that);
  Signal tick();
  bool at_rest() const { return velocity_ == 0 && acceleration_ == 0; }

 private:
  StopLimits limits_ = {};
  Signal position_ = 0;
  int64_t velocity_ = 0;      // LSB/tick
  int64_t acceleration_ = 0;  // LSB/tick^2
};

}  // namespace stillpoint
