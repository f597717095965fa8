// SPDX-License-Identifier: Apache-2.0
// A move as a sequence of jerks +, 0, -, 0, +, ... of given lengths. Background; doubles.
#pragma once

#include <stddef.h>

namespace stillpoint {

constexpr size_t kJerkParts = 21;  // + 0 - 0, five times, and a last +

constexpr double jerk_sign(size_t part) {
  if (part % 2 == 1) return 0.0;
  return part % 4 == 0 ? 1.0 : -1.0;
}

// Units: the jerk is 1, time as one likes.
struct JerkSequence {
  double length[kJerkParts];

  double total() const;
};

struct PathPoint {
  double time;
  double acceleration;
  double velocity;
  double position;
};

// The move at the end of each part, from rest at 0.
class JerkPath {
 public:
  explicit JerkPath(const JerkSequence& sequence);

  const PathPoint& after(size_t part) const { return after_[part]; }
  PathPoint before(size_t part) const { return part == 0 ? PathPoint{} : after_[part - 1]; }
  const PathPoint& end() const { return after_[kJerkParts - 1]; }

  // The velocity is largest, or cruises, as the acceleration falls through zero: in this part?
  bool peaks_in(size_t part) const;
  // That velocity.
  double peak_velocity(size_t part) const;

  // What lengthening the part does to time, acceleration, velocity and position at a later `time`.
  PathPoint effect(size_t part, double time) const;

 private:
  PathPoint after_[kJerkParts];
};

}  // namespace stillpoint
