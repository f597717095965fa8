// SPDX-License-Identifier: Apache-2.0
// The fastest change of velocity from any velocity and acceleration, within acceleration and jerk limits.
//
// Times are in ticks; no tolerance is needed but relative ones. Background; closed form.
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
  double jerk;
};

struct PhaseList {
  // At most 12 (see plan_from.hpp) and what is merged on the way.
  static constexpr uint32_t kCapacity = 14;
  uint32_t count = 0;
  Phase phase[kCapacity];

  // Drops what takes no time and joins what has the jerk of the phase before.
  void append(const Phase& next);
};

struct RampLimits {
  double acceleration;
  double jerk;
};

// While the speed grows and while it falls.
struct BothRamps {
  RampLimits up;
  RampLimits down;
};

// After `ticks` of a jerk.
Motion advanced(const Motion& from, double jerk, double ticks);

// Appends the phases that lead from the velocity and acceleration of `from` to `velocity` and no acceleration.
//
// Let e = a^2/2 and the change be upwards. Over v, full jerk draws a line of slope +j or -j, constant acceleration a
// level; j and the level are those of slowing down for v < 0, of speeding up for v > 0. The fastest change is the
// highest such curve below: the line up from the start, the line down to the end, the levels, and where the upper level
// is the lower of the two, the line down to it that begins before v = 0. At most 5 phases, and 2 before them where an
// acceleration downwards is let go of first, through v = 0.
//
// From above its limit the acceleration is let go first; where no jerk within the limit avoids passing a limit, as
// little as possible is passed.
void append_transition(const Motion& from, double velocity, const BothRamps& limits, PhaseList& phases);

// Appends the phases, two at most, that let go of the acceleration of `from` as fast as the jerk limits allow; the
// velocity they lead to.
double append_let_go(const Motion& from, const BothRamps& limits, PhaseList& phases);

}  // namespace stillpoint
