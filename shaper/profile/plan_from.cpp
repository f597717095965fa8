// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/plan_from.hpp"

#include <float.h>

#include "shaper/base/math.hpp"
#include "shaper/profile/velocity_transition.hpp"

namespace stillpoint {

namespace {

double greater(double a, double b) { return a > b ? a : b; }
double lesser(double a, double b) { return a < b ? a : b; }

// The task in ticks and units of the jerk, turned round where the way leads backwards.
struct Task {
  double unit;  // unit/tick^3, negative where turned round
  double velocity;
  BothRamps limits;
  Motion start;
};

Motion after_all(Motion motion, const PhaseList& phases) {
  for (uint32_t i = 0; i < phases.count; ++i) motion = advanced(motion, phases.phase[i].jerk, phases.phase[i].ticks);
  return motion;
}

// Where stopping at once leads to.
double stop_position(Motion motion, const BothRamps& limits) {
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

// A zero of the function that rises from below zero at 0 to zero or above at `right`. Inverse quadratic interpolation
// where the three points are as on a monotone curve, bisection where not (Chandrupatla 1997).
double root(const Overshoot& overshoot, double right, double tolerance) {
  double x1 = right;
  double f1 = overshoot(x1);
  double x2 = 0.0;
  double f2 = overshoot(x2);
  if (f2 >= 0.0) return x2;
  double part = 0.5;
  for (int step = 0; step < kMaxRootSteps; ++step) {
    const double x = x1 + part * (x2 - x1);
    const double f = overshoot(x);
    const bool same = (f < 0.0) == (f1 < 0.0);
    const double x3 = same ? x1 : x2;
    const double f3 = same ? f1 : f2;
    if (!same) {
      x2 = x1;
      f2 = f1;
    }
    x1 = x;
    f1 = f;
    const double least = DBL_EPSILON * math::abs(x1) / math::abs(x2 - x1);
    if (math::abs(f1) <= tolerance || !(least < 0.5)) break;
    const double xi = (x1 - x2) / (x3 - x2);
    const double phi = (f1 - f2) / (f3 - f2);
    part = 0.5;
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi)
      part = f1 / (f2 - f1) * (f3 / (f2 - f3)) + (x3 - x1) / (x2 - x1) * (f1 / (f3 - f1)) * (f2 / (f3 - f2));
    if (part < least) part = least;
    if (part > 1.0 - least) part = 1.0 - least;
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
      const double tolerance = DBL_EPSILON * (math::abs(distance) + math::abs(motion.position));
      phase.ticks = root(Overshoot{motion, phase.jerk, distance, task.limits}, phase.ticks, tolerance);
      phases.count = phase.ticks > 0.0 ? reached + 1 : reached;
      motion = advanced(motion, phase.jerk, phase.ticks);
      // What no moment between two doubles is near enough for is left to a little cruise.
      constexpr double kLittle = 1e-6;
      PhaseList let_go;
      append_let_go(motion, task.limits, let_go);
      const Motion coasting = after_all(motion, let_go);
      if (motion.acceleration <= 0.0 || coasting.velocity <= 0.0)
        return append_transition(motion, 0.0, task.limits, phases);
      for (uint32_t i = 0; i < let_go.count; ++i) phases.append(let_go.phase[i]);
      return append_cruise_and_stop(Motion{coasting.position, coasting.velocity, 0.0}, distance, kLittle, task.limits,
                                    phases);
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
  if (math::abs(distance - stop) <= 8.0 * DBL_EPSILON * (math::abs(distance) + math::abs(stop)))
    return append_transition(task.start, 0.0, task.limits, phases);
  if (distance < stop) {
    task.unit = -task.unit;
    task.start.velocity = -task.start.velocity;
    task.start.acceleration = -task.start.acceleration;
    distance = -distance;
  }
  solve_forward(task, distance, phases);
}

Status check(const StartMotion& start, double goal, Quantity quantity, const AxisLimits& limits, double tick_s) {
  if (!math::is_finite(start.velocity)) return refuse(Error::kNotFinite, Quantity::kVelocity, start.velocity);
  if (!math::is_finite(start.acceleration))
    return refuse(Error::kNotFinite, Quantity::kAcceleration, start.acceleration);
  if (!math::is_finite(goal)) return refuse(Error::kNotFinite, quantity, goal);
  const Status status = limits.validate();
  if (!status.ok()) return status;
  if (!math::is_finite(tick_s)) return refuse(Error::kNotFinite, Quantity::kTick, tick_s);
  if (!(tick_s > 0.0)) return refuse(Error::kNotPositive, Quantity::kTick, tick_s);
  return kOk;
}

// Twice the least jerk that lets go of the acceleration before the velocity limit is passed, or, where the velocity
// turns round on the way, before what was deceleration passes the acceleration limit, or what the other jerk can still
// let go of within the velocity limit.
double keeping_jerk(const Motion& start, double limit, const RampLimits& up) {
  const double speed = math::abs(start.velocity);
  const double square = math::square(start.acceleration);
  if ((start.velocity > 0.0) == (start.acceleration > 0.0)) return square / (limit - speed);
  const double turning = square - lesser(math::square(up.acceleration), 2.0 * up.jerk * limit);
  return greater(square / (limit + speed), turning / speed);
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
  const double speed = math::abs(motion.velocity);
  const double steepness = math::abs(motion.acceleration);
  const double strongest = greater(greater(up.acceleration, down.acceleration), steepness);
  const double farthest = greater(greater(reach, speed), steepness);
  const double enough = lesser(kPerAcceleration * strongest, kPerReach * farthest);
  const double useful = greater(keeping_jerk(motion, limit, up), enough);
  up.jerk = lesser(up.jerk, useful);
  down.jerk = lesser(down.jerk, useful);
  // Cruising stays this much below its limit, so that a track's rounding over a million ticks does not pass it.
  constexpr double kBelowLimit = 1.0 - 1024.0 * DBL_EPSILON;
  const double unit = up.jerk;
  return Task{unit, greater(kBelowLimit * limit, speed > limit ? 0.0 : speed) / unit,
              BothRamps{{up.acceleration / unit, 1.0}, {down.acceleration / unit, down.jerk / unit}},
              Motion{0.0, motion.velocity / unit, motion.acceleration / unit}};
}

// Writes the phases and, to the end of the last tick, what the last of them leads to.
Status write(const Task& task, PhaseList& phases, double tick_s, Plan& out) {
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
    out.segments[i] = Segment{phase.ticks, phase.acceleration * task.unit, phase.jerk * task.unit};
  }
  return kOk;
}

}  // namespace

Status plan_from(const StartMotion& start, double distance, const AxisLimits& limits, double tick_s, Plan& out) {
  Status status = check(start, distance, Quantity::kDistance, limits, tick_s);
  if (!status.ok()) return status;
  PhaseList phases;
  Plan plan{};
  plan.distance = distance;
  plan.start_velocity = start.velocity * tick_s;
  const bool moves = distance != 0.0 || start.velocity != 0.0 || start.acceleration != 0.0;
  if (moves) {
    Task task = task_of(start, math::abs(distance), limits, tick_s);
    solve(task, distance / task.unit, phases);
    status = write(task, phases, tick_s, plan);
  }
  if (status.ok()) out = plan;
  return status;
}

Status plan_to_velocity(const StartMotion& start, double velocity, const AxisLimits& limits, double tick_s, Plan& out) {
  Status status = check(start, velocity, Quantity::kVelocity, limits, tick_s);
  if (!status.ok()) return status;
  if (math::abs(velocity) > limits.velocity)
    return refuse(Error::kAboveMaximum, Quantity::kVelocity, velocity, limits.velocity);
  PhaseList phases;
  Plan plan{};
  plan.start_velocity = start.velocity * tick_s;
  if (velocity != 0.0 || start.velocity != 0.0 || start.acceleration != 0.0) {
    const Task task = task_of(start, math::abs(velocity * tick_s), limits, tick_s);
    append_transition(task.start, velocity * tick_s / task.unit, task.limits, phases);
    status = write(task, phases, tick_s, plan);
    plan.distance = after_all(task.start, phases).position * task.unit;
  }
  if (status.ok()) out = plan;
  return status;
}

}  // namespace stillpoint
