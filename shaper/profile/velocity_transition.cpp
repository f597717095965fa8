// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/velocity_transition.hpp"

#include <float.h>

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

[[gnu::noinline]] double half_square(double a) { return a * a / 2.0; }

// A change upwards; `sign` turns it round for one downwards.
class Rise {
 public:
  Rise(const Motion& from, double sign, PhaseList& phases)
      : velocity_(sign * from.velocity), acceleration_(sign * from.acceleration), sign_(sign), phases_(phases) {}

  double velocity() const { return sign_ * velocity_; }

  void to(double target, double rounding, const BothRamps& limits) {
    if (acceleration_ < 0.0) let_go(limits);
    if (target - velocity_ <= rounding && acceleration_ == 0.0) return;
    if (velocity_ < 0.0) {
      const double level = half_square(limits.up.acceleration);
      rise_to(math::lesser(target, 0.0), target > 0.0 ? math::lesser(level, limits.up.jerk * target) : 0.0,
              limits.down);
    }
    if (target > 0.0) rise_to(target, 0.0, limits.up);
  }

  // Of an acceleration below zero: by the jerk of slowing down as far as v = 0, then by the other.
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
    const double least = math::lesser(level, end_energy);
    if (energy - climb > least)
      return end_energy > 0.0 ? fall_to(end, energy - climb, limits.jerk) : jerk_to(0.0, limits.jerk);
    if (energy + climb <= least) return jerk_to_end(acceleration_at(energy + climb), end, limits.jerk);
    const double apex = (climb + end_energy + energy) / 2.0;
    jerk_to(apex > level ? limits.acceleration : acceleration_at(apex), limits.jerk);
    if (apex > level) append((end - (level - least) / limits.jerk - velocity_) / acceleration_, acceleration_, 0.0);
    if (end_energy == 0.0 || (end_energy < level && math::lesser(apex, level) <= climb)) {
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
    append(math::magnitude(change) / jerk, acceleration, change < 0.0 ? -jerk : jerk);
  }

  // The same where the velocity at its end is known better than the change of acceleration: a jerk may be next to none.
  [[gnu::noinline]] void jerk_to_end(double acceleration, double end, double jerk) {
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
  static constexpr double kOver[] = {1.0, 1.0 / 2.0, 1.0 / 3.0};
  const double derivative[] = {from.position, from.velocity, from.acceleration};
  double result[3];
  for (int k = 0; k < 3; ++k) {  // Taylor's series, from its end
    double sum = jerk;
    for (int i = 2; i >= k; --i) {
      sum *= ticks;
      if (i > k) sum *= kOver[i - k];
      sum += derivative[i];
    }
    result[k] = sum;
  }
  return Motion{result[0], result[1], result[2]};
}

void append_transition(const Motion& from, double velocity, const BothRamps& limits, PhaseList& phases) {
  PhaseList unused;
  const double let_go = from.acceleration == 0.0 ? from.velocity : append_let_go(from, limits, unused);
  const double sign = let_go > velocity ? -1.0 : 1.0;
  const double rounding =
      4.0 * DBL_EPSILON * (math::magnitude(from.velocity) + 2.0 * math::magnitude(let_go - from.velocity));
  Rise(from, sign, phases).to(sign * velocity, rounding, limits);
}

double append_let_go(const Motion& from, const BothRamps& limits, PhaseList& phases) {
  Rise rise(from, from.acceleration > 0.0 ? -1.0 : 1.0, phases);
  rise.let_go(limits);
  return rise.velocity();
}

}  // namespace stillpoint
