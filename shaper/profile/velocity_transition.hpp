// SPDX-License-Identifier: Apache-2.0
// The fastest change of velocity from any velocity and acceleration, within acceleration and jerk limits.
//
// Lengths here are in units of the jerk limit, times in ticks, so that a jerk is -1, 0 or 1, an acceleration is the
// ticks it takes to let go of it, and no tolerance is needed but relative ones. Background; closed form.
#pragma once

#include <stdint.h>

namespace stillpoint {

struct Motion {
  double position;
  double velocity;
  double acceleration;
};

struct Phase {
  double ticks;
  double acceleration;  // at its start
  double jerk;          // -1, 0 or 1
};

struct PhaseList {
  // At most 10 (see plan_from.hpp) and what is merged or dropped on the way.
  static constexpr uint32_t kCapacity = 12;
  uint32_t count = 0;
  Phase phase[kCapacity];

  // Drops what takes no time and joins what has the jerk of the phase before.
  void append(const Phase& next);
};

// While the speed grows and while it falls.
struct AccelerationPair {
  double acceleration;
  double deceleration;
};

// After `ticks` of a jerk.
Motion advanced(const Motion& from, double jerk, double ticks);

// Appends the phases that lead from the velocity and acceleration of `from` to `velocity` and no acceleration.
//
// Let e = a^2/2 and the change be upwards. Over v, full jerk draws a line of slope +1 or -1, constant acceleration a
// level; the fastest change is the highest such line below: the line up from the start, the line down to the end, the
// level of the deceleration limit for v < 0, that of the acceleration limit for v > 0, and where that is the lower of
// the two, the line down to it that begins before v = 0. At most 5 phases.
//
// From above its limit the acceleration is let go first; where no jerk within the limit avoids passing a limit, as
// little as possible is passed.
void append_transition(const Motion& from, double velocity, const AccelerationPair& limits, PhaseList& phases);

}  // namespace stillpoint
