// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/velocity_transition.hpp"

#include <float.h>

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

double lesser(double a, double b) { return a < b ? a : b; }

double half_square(double a) { return a * a / 2.0; }

// The velocity once the acceleration has been let go: by the jerk of slowing down as far as v = 0, then by the other.
double let_go_velocity(const Motion& from, const BothRamps& limits) {
  const double energy = math::copysign(half_square(from.acceleration), from.acceleration);
  const double v = from.velocity;
  if ((v > 0.0) == (energy > 0.0)) return v + energy / limits.up.jerk;
  const double let_go = v + energy / limits.down.jerk;
  return (let_go > 0.0) == (v > 0.0) ? let_go : let_go * (limits.down.jerk / limits.up.jerk);
}

// A change upwards; `sign` turns it round for one downwards.
class Rise {
 public:
  Rise(const Motion& from, double sign, PhaseList& phases)
      : velocity_(sign * from.velocity), acceleration_(sign * from.acceleration), sign_(sign), phases_(phases) {}

  void to(double target, double rounding, const BothRamps& limits) {
    if (acceleration_ < 0.0) let_go(limits);
    if (target - velocity_ <= rounding && acceleration_ == 0.0) return;
    if (velocity_ < 0.0) {
      const double level = half_square(limits.up.acceleration);
      rise_to(lesser(target, 0.0), target > 0.0 ? lesser(level, limits.up.jerk * target) : 0.0, limits.down);
    }
    if (target > 0.0) rise_to(target, 0.0, limits.up);
  }

  // Of an acceleration below zero.
  void let_go(const BothRamps& limits) {
    if (velocity_ > 0.0) {
      const double rest = half_square(acceleration_) - limits.down.jerk * velocity_;
      if (rest <= 0.0) return jerk_to(0.0, limits.down.jerk);
      jerk_to_end(-acceleration_at(rest), 0.0, limits.down.jerk);
    }
    jerk_to(0.0, limits.up.jerk);
  }

 private:
  // To the velocity `end` within limits that hold all the way; at its end the energy is `end_energy` at the most.
  void rise_to(double end, double end_energy, const RampLimits& limits) {
    const double energy = half_square(acceleration_);
    const double level = half_square(limits.acceleration);
    const double climb = limits.jerk * (end - velocity_);
    const double least = lesser(level, end_energy);
    if (energy - climb > least)
      return end_energy > 0.0 ? fall_to(end, energy - climb, limits.jerk) : jerk_to(0.0, limits.jerk);
    if (energy + climb <= least) return jerk_to_end(acceleration_at(energy + climb), end, limits.jerk);
    const double apex = (climb + end_energy + energy) / 2.0;
    jerk_to(apex > level ? limits.acceleration : acceleration_at(apex), limits.jerk);
    if (apex > level) append((end - (level - least) / limits.jerk - velocity_) / acceleration_, acceleration_, 0.0);
    if (end_energy == 0.0 || (end_energy < level && lesser(apex, level) <= climb)) {
      jerk_to(acceleration_at(end_energy), limits.jerk);
    } else if (end_energy < level) {
      fall_to(end, end_energy, limits.jerk);
    }
    velocity_ = end;
  }

  void fall_to(double end, double energy, double jerk) { jerk_to_end(acceleration_at(energy), end, -jerk); }

  static double acceleration_at(double energy) { return energy > 0.0 ? math::sqrt(2.0 * energy) : 0.0; }

  void jerk_to(double acceleration, double jerk) {
    const double change = acceleration - acceleration_;
    append(math::abs(change) / jerk, acceleration, change < 0.0 ? -jerk : jerk);
  }

  // The same where the velocity at its end is known better than the change of acceleration: a jerk may be next to none.
  void jerk_to_end(double acceleration, double end, double jerk) {
    append(2.0 * (end - velocity_) / (acceleration_ + acceleration), acceleration, jerk);
    velocity_ = end;
  }

  void append(double ticks, double end_acceleration, double jerk) {
    phases_.append(Phase{ticks, sign_ * acceleration_, sign_ * jerk});
    velocity_ += (acceleration_ + end_acceleration) / 2.0 * ticks;
    acceleration_ = end_acceleration;
  }

  double velocity_;
  double acceleration_;
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

void append_transition(const Motion& from, double velocity, const BothRamps& limits, PhaseList& phases) {
  const double let_go = let_go_velocity(from, limits);
  const double sign = let_go > velocity ? -1.0 : 1.0;
  const double rounding = 4.0 * DBL_EPSILON * (math::abs(from.velocity) + 2.0 * math::abs(let_go - from.velocity));
  Rise(from, sign, phases).to(sign * velocity, rounding, limits);
}

void append_let_go(const Motion& from, const BothRamps& limits, PhaseList& phases) {
  Rise(from, from.acceleration > 0.0 ? -1.0 : 1.0, phases).let_go(limits);
}

}  // namespace stillpoint
