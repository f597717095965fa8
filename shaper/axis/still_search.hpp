// SPDX-License-Identifier: Apache-2.0
// From a plain move to one that leaves the modes still: sequential linear programming over a sequence of jerks.
#pragma once

#include <stddef.h>

#include "shaper/axis/jerk_sequence.hpp"
#include "shaper/axis/mode_weight.hpp"
#include "shaper/base/small_lp.hpp"
#include "shaper/shaping/mode.hpp"

namespace stillpoint {

constexpr size_t kMostStillModes = 3;

// Limits and distance with the jerk as one and the plain duration as the unit of time.
struct StillLimits {
  double velocity;
  double acceleration;
  double deceleration;
  double distance;
};

class StillSearch {
 public:
  // `plain`: a move of total length 1 within the limits over the distance, `plain_ticks` long. A unit of what is not
  // kept is worth `penalty` of time.
  StillSearch(const JerkSequence& plain, double plain_ticks, const StillLimits& limits, double penalty);

  void add_mode(const Mode& mode, double tick_s);  // at most kMostStillModes

  // Part `k` is a long cruise: held at no acceleration, however little of it would do over so long a time.
  void hold(size_t k) { cruise_ = k; }

  // The plain move is the best of those that leave the modes what it leaves them. From there it is led, in stages, to
  // what leaves them nothing. True if everything is kept to 1e-10 in the end.
  // Cost: at most kMostProgrammes linear programmes of kJerkParts variables.
  bool run();

  const JerkSequence& sequence() const { return sequence_; }

  static constexpr int kMostProgrammes = 400;

 private:
  // Rows of the programme are in the changes of the lengths; those begin at `low`.
  using Row = double[kJerkParts];
  static void add(SmallLp& lp, const Row& row, double right, bool equality, const Row& low);
  void add_end(SmallLp& lp, const JerkPath& path, const Row& low) const;
  void add_modes(SmallLp& lp, const JerkPath& path, const Row& low) const;
  void add_limits(SmallLp& lp, const JerkPath& path, const Row& low) const;

  Complex left_in(size_t mode, const JerkPath& path, Complex* slopes) const;
  double violation(const JerkSequence& sequence) const;
  double merit(const JerkSequence& sequence) const;
  JerkSequence stepped(const JerkSequence& sequence, double trust) const;
  JerkSequence corrected(const JerkSequence& sequence, double trust) const;
  void descend(int steps);
  void drop_slivers();

  JerkSequence sequence_;
  double plain_ticks_;
  StillLimits limits_;
  double penalty_;
  double first_trust_ = 0.1;
  double mode_scale_;  // ticks: a plain duration, or a period
  double acceleration_scale_ = 0.0;
  double velocity_scale_ = 0.0;
  size_t cruise_ = 0;
  bool dropped_[kJerkParts] = {};
  size_t mode_count_ = 0;
  ModeWeight modes_[kMostStillModes] = {};
  Complex goal_[kMostStillModes] = {};  // what they are left with at this stage
};

}  // namespace stillpoint
