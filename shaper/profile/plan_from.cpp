// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/plan_from.hpp"

#include <float.h>

#include "shaper/base/math.hpp"
#include "shaper/profile/velocity_transition.hpp"

namespace stillpoint {

namespace {

// The task in ticks, turned round by a sign of -1 where the way leads backwards.
struct Task {
  double sign;
  double velocity;
  BothRamps limits;
  Motion start;
};

Motion after_all(const Motion& from, const PhaseList& phases) {
  Motion motion = from;
  for (uint32_t i = 0; i < phases.count; ++i) motion = advanced(motion, phases.phase[i].jerk, phases.phase[i].ticks);
  return motion;
}

// Where stopping at once leads to.
double stop_position(const Motion& motion, const BothRamps& limits) {
  PhaseList stop;
  append_transition(motion, 0.0, limits, stop);
  return after_all(motion, stop).position;
}

// How far beyond the target a stop ends that begins some time into a phase.
struct Overshoot {
  const Motion& begin;
  double jerk;
  double distance;
  const BothRamps& limits;
  double operator()(double ticks) const { return stop_position(advanced(begin, jerk, ticks), limits) - distance; }
};

// A zero of the function that rises from below zero at 0 to zero or above at `right`: regula falsi, where the value of
// an end that stays is scaled down (Anderson and Bjorck 1973); every other step halves a bracket that has not halved.
double root(const Overshoot& overshoot, double right, double tolerance) {
  double x1 = right;
  double f1 = overshoot(x1);
  double x2 = 0.0;
  double f2 = overshoot(x2);
  if (f2 >= 0.0) return x2;
  double width = right;
  for (int step = 0; step < kMaxRootSteps && math::magnitude(f1) > tolerance; ++step) {
    const double bracket = x2 - x1;
    const double least = DBL_EPSILON * x1;
    if (!(least < 0.5 * math::magnitude(bracket))) break;
    double change = f1 / (f1 - f2) * bracket;
    if (step % 2 == 1) {
      if (math::magnitude(bracket) > 0.5 * width) change = 0.5 * bracket;
      width = math::magnitude(bracket);
    }
    if (math::magnitude(change) < least) change = math::copysign(least, bracket);
    const double x = x1 + change;
    const double f = overshoot(x);
    if ((f < 0.0) != (f1 < 0.0)) {
      x2 = x1;
      f2 = f1;
    } else {
      const double part = 1.0 - f / f1;
      f2 *= part > 0.0 ? part : 0.5;
    }
    x1 = x;
    f1 = f;
  }
  return f1 > tolerance ? x2 : x1;  // rather too near than too far
}

// Without acceleration at `motion`: on at its velocity as far as it takes, if in `most_ticks` at most; and to rest.
void append_cruise_and_stop(const Motion& motion, double distance, double most_ticks, const BothRamps& limits,
                            PhaseList& phases) {
  const double ticks = (distance - stop_position(motion, limits)) / motion.velocity;
  if (ticks <= most_ticks) phases.append(Phase{ticks, 0.0, 0.0});
  append_transition(motion, 0.0, limits, phases);
}

// The phases to rest at `distance` >= stop_position(task.start).
void solve_forward(const Task& task, double distance, PhaseList& phases) {
  append_transition(task.start, task.velocity, task.limits, phases);
  Motion motion = task.start;
  uint32_t reached = 0;
  for (; reached < phases.count; ++reached) {
    Phase& phase = phases.phase[reached];
    const Motion end = advanced(motion, phase.jerk, phase.ticks);
    if (stop_position(end, task.limits) >= distance) {
      const double tolerance = DBL_EPSILON * (math::magnitude(distance) + math::magnitude(motion.position));
      phase.ticks = root(Overshoot{motion, phase.jerk, distance, task.limits}, phase.ticks, tolerance);
      phases.count = phase.ticks > 0.0 ? reached + 1 : reached;
      motion = advanced(motion, phase.jerk, phase.ticks);
      // What no moment between two doubles is near enough for is left to a little cruise.
      constexpr double kLittle = 1e-6;
      PhaseList let_go;
      const double velocity = append_let_go(motion, task.limits, let_go);
      if (motion.acceleration <= 0.0 || velocity <= 0.0) return append_transition(motion, 0.0, task.limits, phases);
      for (uint32_t i = 0; i < let_go.count; ++i) phases.append(let_go.phase[i]);
      motion = after_all(motion, let_go);
      motion.acceleration = 0.0;
      return append_cruise_and_stop(motion, distance, kLittle, task.limits, phases);
    }
    motion = end;
  }
  motion.velocity = task.velocity;
  motion.acceleration = 0.0;
  append_cruise_and_stop(motion, distance, math::kInfinity, task.limits, phases);
}

void solve(Task& task, double distance, PhaseList& phases) {
  const double stop = stop_position(task.start, task.limits);
  // Nearer than rounding can tell: the stop itself, or a direction would be chosen by chance.
  if (math::magnitude(distance - stop) <= 8.0 * DBL_EPSILON * (math::magnitude(distance) + math::magnitude(stop)))
    return append_transition(task.start, 0.0, task.limits, phases);
  if (distance < stop) {
    task.sign = -1.0;
    task.start.velocity = -task.start.velocity;
    task.start.acceleration = -task.start.acceleration;
    distance = -distance;
  }
  solve_forward(task, distance, phases);
}

Status check(const StartMotion& start, double goal, Quantity quantity, const AxisLimits& limits, double tick_s) {
  Status status = check_finite(Quantity::kVelocity, start.velocity);
  if (status.ok()) status = check_finite(Quantity::kAcceleration, start.acceleration);
  if (status.ok()) status = check_finite(quantity, goal);
  return status.ok() ? limits.validate(tick_s) : status;
}

// Twice the least jerk that lets go of the acceleration before the velocity limit is passed, or, where the velocity
// turns round on the way, before what was deceleration passes the acceleration limit, or what the other jerk can still
// let go of within the velocity limit.
double keeping_jerk(const Motion& start, double limit, const RampLimits& up) {
  const double speed = math::magnitude(start.velocity);
  const double square = math::square(start.acceleration);
  if ((start.velocity > 0.0) == (start.acceleration > 0.0)) return square / (limit - speed);
  const double turning = square - math::lesser(math::square(up.acceleration), 2.0 * up.jerk * limit);
  return math::greater(square / (limit + speed), turning / speed);
}

// `reach`: the move's distance or change of velocity, in ticks.
Task task_of(const StartMotion& start, double reach, const AxisLimits& limits, double tick_s) {
  constexpr double kPerAcceleration = 1024.0;
  constexpr double kPerReach = 4096.0;
  const double tick_2 = tick_s * tick_s;
  const Motion motion{0.0, start.velocity * tick_s, start.acceleration * tick_2};
  const double limit = limits.velocity * tick_s;
  RampLimits up{limits.acceleration * tick_2, limits.jerk * tick_2 * tick_s};
  RampLimits down{limits.deceleration * tick_2, limits.braking_jerk() * tick_2 * tick_s};
  const double speed = math::magnitude(motion.velocity);
  const double steepness = math::magnitude(motion.acceleration);
  const double strongest = math::greater(math::greater(up.acceleration, down.acceleration), steepness);
  const double farthest = math::greater(math::greater(reach, speed), steepness);
  const double enough = math::lesser(kPerAcceleration * strongest, kPerReach * farthest);
  const double useful = math::greater(keeping_jerk(motion, limit, up), enough);
  up.jerk = math::lesser(up.jerk, useful);
  down.jerk = math::lesser(down.jerk, useful);
  // Cruising stays this much below its limit, so that a track's rounding over a million ticks does not pass it.
  constexpr double kBelowLimit = 1.0 - 1024.0 * DBL_EPSILON;
  return Task{1.0, math::greater(kBelowLimit * limit, speed > limit ? 0.0 : speed), BothRamps{up, down}, motion};
}

// Writes the phases and, to the end of the last tick, what the last of them leads to.
[[gnu::noinline]] Status write(const Task& task, PhaseList& phases, double tick_s, Plan& out) {
  double ticks = 0.0;
  for (uint32_t i = 0; i < phases.count; ++i) ticks += phases.phase[i].ticks;
  if (!(ticks <= kMaxDurationTicks))
    return refuse(Error::kAboveMaximum, Quantity::kDuration, ticks * tick_s, kMaxDurationTicks * tick_s);
  out.optimum_ticks = ticks;
  out.duration_ticks = phases.count == 0 ? 0 : whole_ticks(ticks);
  phases.append(Phase{out.duration_ticks - ticks, 0.0, 0.0});
  out.segment_count = phases.count;
  for (uint32_t i = 0; i < phases.count; ++i) {
    const Phase& phase = phases.phase[i];
    out.segments[i] = Segment{phase.ticks, task.sign * phase.acceleration, task.sign * phase.jerk};
  }
  return kOk;
}

// To rest at the distance `goal`, or to the velocity `goal`.
Status plan_to(const StartMotion& start, double goal, Quantity of, const AxisLimits& limits, double tick_s, Plan& out) {
  Status status = check(start, goal, of, limits, tick_s);
  if (!status.ok()) return status;
  const bool to_velocity = of == Quantity::kVelocity;
  if (to_velocity && math::magnitude(goal) > limits.velocity)
    return refuse(Error::kAboveMaximum, Quantity::kVelocity, goal, limits.velocity);
  PhaseList phases;
  Plan plan{};
  plan.start_velocity = start.velocity * tick_s;
  if (goal != 0.0 || start.velocity != 0.0 || start.acceleration != 0.0) {
    const double way = to_velocity ? goal * tick_s : goal;
    Task task = task_of(start, math::magnitude(way), limits, tick_s);
    if (to_velocity) {
      append_transition(task.start, way, task.limits, phases);
    } else {
      solve(task, way, phases);
    }
    status = write(task, phases, tick_s, plan);
    plan.distance = to_velocity ? after_all(task.start, phases).position : goal;
  }
  if (status.ok()) out = plan;
  return status;
}

}  // namespace

Status plan_from(const StartMotion& start, double distance, const AxisLimits& limits, double tick_s, Plan& out) {
  return plan_to(start, distance, Quantity::kDistance, limits, tick_s, out);
}

Status plan_to_velocity(const StartMotion& start, double velocity, const AxisLimits& limits, double tick_s, Plan& out) {
  return plan_to(start, velocity, Quantity::kVelocity, limits, tick_s, out);
}

}  // namespace stillpoint
