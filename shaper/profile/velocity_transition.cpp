// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/velocity_transition.hpp"

#include <float.h>

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

double lesser(double a, double b) { return a < b ? a : b; }

double half_square(double a) { return a * a / 2.0; }

// A change upwards; `sign` turns it round for one downwards.
class Rise {
 public:
  Rise(const Motion& from, double sign, PhaseList& phases)
      : velocity_(sign * from.velocity),
        acceleration_(sign * from.acceleration),
        rounding_(4.0 * DBL_EPSILON * (math::abs(from.velocity) + math::square(from.acceleration))),
        sign_(sign),
        phases_(phases) {}

  void to(double target, const AccelerationPair& limits) {
    if (acceleration_ < 0.0) {
      const double turn = velocity_ - half_square(acceleration_);
      jerk_to(0.0, turn);
    }
    if (target - velocity_ <= rounding_ && acceleration_ == 0.0) return;
    if (velocity_ < 0.0)
      zone(limits.deceleration, lesser(half_square(limits.acceleration), target), lesser(0.0, target));
    if (target > 0.0) zone(limits.acceleration, target, target);
  }

 private:
  void jerk_to(double acceleration, double velocity) {
    const double change = acceleration - acceleration_;
    phases_.append(Phase{math::abs(change), sign_ * acceleration_, change < 0.0 ? -sign_ : sign_});
    acceleration_ = acceleration;
    velocity_ = velocity;
  }
  void hold_to(double velocity) {
    phases_.append(Phase{(velocity - velocity_) / acceleration_, sign_ * acceleration_, 0.0});
    velocity_ = velocity;
  }
  // Along the line of full jerk (slope +1 or -1) to the velocity `end`.
  void jerk_along(double slope, double end) {
    const double square = 2.0 * (half_square(acceleration_) + slope * (end - velocity_));
    jerk_to(square > 0.0 ? math::sqrt(square) : 0.0, end);
  }

  // From outside: true where letting go takes the whole zone.
  bool let_go(double ceiling, double line, double end) {
    double energy = half_square(acceleration_);
    const double over = energy - half_square(ceiling);
    if (over > 0.0) {
      if (velocity_ + over >= end) {
        jerk_along(-1.0, end);
        return true;
      }
      jerk_to(ceiling, velocity_ + over);
      energy = half_square(ceiling);
    }
    if (energy <= line - velocity_) return false;
    jerk_along(-1.0, end);
    if (line <= end) finish();
    return true;
  }

  // Below the level of the acceleration `ceiling` and the line e = line - v, to the velocity `end` <= line.
  void zone(double ceiling, double line, double end) {
    if (let_go(ceiling, line, end)) return;
    const double energy = half_square(acceleration_);
    const double level = half_square(ceiling);
    const double apex = (line - velocity_ + energy) / 2.0;
    const bool holds = apex > level;
    const double top = holds ? level : apex;
    const double top_velocity = velocity_ + (top - energy);
    if (line > end && top_velocity >= end) return jerk_along(1.0, end);
    jerk_to(holds ? ceiling : math::sqrt(2.0 * top), top_velocity);
    if (holds) {
      const double release = line - level;
      if (line > end && release >= end) return hold_to(end);
      hold_to(release);
    }
    if (line > end) return jerk_to(math::sqrt(2.0 * (line - end)), end);
    jerk_to(0.0, end);
  }

  // What rounding has left of the acceleration where there must be none.
  void finish() {
    if (acceleration_ > 0.0) jerk_to(0.0, velocity_);
  }

  double velocity_;
  double acceleration_;
  double rounding_;
  double sign_;
  PhaseList& phases_;
};

}  // namespace

void PhaseList::append(const Phase& next) {
  if (!(next.ticks > 0.0)) return;
  if (count > 0 && phase[count - 1].jerk == next.jerk) {
    phase[count - 1].ticks += next.ticks;
  } else if (count < kCapacity) {
    phase[count++] = next;
  }
}

Motion advanced(const Motion& from, double jerk, double ticks) {
  const double a = from.acceleration;
  return Motion{from.position + ticks * (from.velocity + ticks * (a / 2.0 + ticks * (jerk / 6.0))),
                from.velocity + ticks * (a + ticks * (jerk / 2.0)), a + jerk * ticks};
}

void append_transition(const Motion& from, double velocity, const AccelerationPair& limits, PhaseList& phases) {
  const double let_go = from.velocity + math::copysign(half_square(from.acceleration), from.acceleration);
  const double sign = let_go > velocity ? -1.0 : 1.0;
  Rise(from, sign, phases).to(sign * velocity, limits);
}

}  // namespace stillpoint
