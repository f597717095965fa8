// SPDX-License-Identifier: Apache-2.0
// The soonest shaped move: what a shaper takes off the peaks is given back to the profile, to each limit its own part.
#pragma once

#include <stdint.h>

#include "shaper/axis/axis_config.hpp"
#include "shaper/axis/zero_delay.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/shaping/design.hpp"

namespace stillpoint {

// A plan whose shaped stream is known to keep the limits.
struct CheckedPlan {
  Plan plan;
  MoveTiming timing;
  Quantity binding;  // the limit that the stream would break if the plan were a tick shorter
  Peaks peaks;       // of the shaped stream, counts/s^n
  double use;        // the largest part that one of them is of its limit
};

// Searches for the profile whose shaped stream is soonest. Two ways:
//   - the plain plan scaled in time, until its stream meets its most binding limit (MoveTiming::kScaled);
//   - the plan for raised limits (kRaised). A phase shorter than the gap between two impulses never meets its own echo,
//     so it may have 1/A times the jerk, A the largest impulse: 1.7 times behind a ZV of 0.586 and 0.414. Acceleration
//     phases are longer and meet theirs. So acceleration, jerk and, where the move does not cruise for longer than the
//     shaper, velocity have a factor each. Whether a pair will do is not monotone in both, so it is no descent: the
//     jerk's by bisection at the acceleration of the move, the acceleration's by bisection at three jerks, then the
//     velocity's, and what is left by scaling in time.
// Every step is judged by the stream itself, so a shaper with negative gains needs no other rule.
class SoonestSearch {
 public:
  // `design` is what `check` runs; `plain` keeps the limits behind it and takes at most kLongestSearchTicks.
  SoonestSearch(ShapedMoveCheck& check, const ShaperDesign& design, const Move& move, const Plan& plain, double tick_s);

  // Cost: at most kMostChecks checks, each of at most the plain plan's ticks and the shaper's; half as many plans.
  CheckedPlan find();

  static constexpr uint32_t kMostChecks = 62;

 private:
  // Of the limits of the move.
  struct Factors {
    double velocity;
    double acceleration;
    double jerk;
  };

  bool breaks(const Factors& factors);
  double largest(double Factors::*factor, const Factors& begin, double low, double high);
  void keep(const Plan& plan, MoveTiming timing);
  void scale();
  void raise_limits();

  ShapedMoveCheck& check_;
  const Move& move_;
  double tick_s_;
  double most_;  // factor
  Factors best_factors_ = {1.0, 1.0, 1.0};
  CheckedPlan best_ = {};
};

}  // namespace stillpoint
