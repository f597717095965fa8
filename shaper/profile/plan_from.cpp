// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/plan_from.hpp"

#include <float.h>

#include "shaper/base/math.hpp"
#include "shaper/profile/velocity_transition.hpp"

namespace stillpoint {

namespace {

double greater(double a, double b) { return a > b ? a : b; }
double lesser(double a, double b) { return a < b ? a : b; }

// The task in ticks and units of the jerk.
struct Task {
  double jerk;  // unit/tick^3
  double velocity;
  AccelerationPair limits;
  Motion start;
};

// Where stopping at once leads to.
double stop_position(Motion motion, const AccelerationPair& limits) {
  PhaseList stop;
  append_transition(motion, 0.0, limits, stop);
  for (uint32_t i = 0; i < stop.count; ++i) motion = advanced(motion, stop.phase[i].jerk, stop.phase[i].ticks);
  return motion.position;
}

// How far beyond the target a stop ends that begins some time into a phase.
struct Overshoot {
  const Motion& begin;
  double jerk;
  double distance;
  const AccelerationPair& limits;
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
  return x1;
}

void append_all(const PhaseList& from, uint32_t count, double sign, PhaseList& to) {
  for (uint32_t i = 0; i < count; ++i) {
    const Phase& phase = from.phase[i];
    to.append(Phase{phase.ticks, sign * phase.acceleration, sign * phase.jerk});
  }
}

// The phases to rest at `distance` >= stop_position(task.start), turned round by a `sign` of -1.
void solve_forward(const Task& task, double distance, double sign, PhaseList& phases) {
  PhaseList forward;
  append_transition(task.start, task.velocity, task.limits, forward);
  Motion motion = task.start;
  uint32_t reached = 0;
  for (; reached < forward.count; ++reached) {
    Phase& phase = forward.phase[reached];
    const Motion end = advanced(motion, phase.jerk, phase.ticks);
    if (stop_position(end, task.limits) >= distance) {
      const double tolerance = DBL_EPSILON * (math::abs(distance) + math::abs(motion.position));
      phase.ticks = root(Overshoot{motion, phase.jerk, distance, task.limits}, phase.ticks, tolerance);
      motion = advanced(motion, phase.jerk, phase.ticks);
      append_all(forward, reached + 1, sign, phases);
      break;
    }
    motion = end;
  }
  if (reached == forward.count) {
    motion.velocity = task.velocity;
    motion.acceleration = 0.0;
    append_all(forward, forward.count, sign, phases);
    phases.append(Phase{(distance - stop_position(motion, task.limits)) / task.velocity, 0.0, 0.0});
  }
  PhaseList stop;
  append_transition(motion, 0.0, task.limits, stop);
  append_all(stop, stop.count, sign, phases);
}

void solve(const Task& task, double distance, PhaseList& phases) {
  const double stop = stop_position(task.start, task.limits);
  // Nearer than rounding can tell: the stop itself, or a direction would be chosen by chance.
  if (math::abs(distance - stop) <= 8.0 * DBL_EPSILON * (math::abs(distance) + math::abs(stop)))
    return append_transition(task.start, 0.0, task.limits, phases);
  if (distance > stop) return solve_forward(task, distance, 1.0, phases);
  Task mirrored = task;
  mirrored.start.velocity = -task.start.velocity;
  mirrored.start.acceleration = -task.start.acceleration;
  solve_forward(mirrored, -distance, -1.0, phases);
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
// turns round on the way, before what was deceleration passes the acceleration limit.
double keeping_jerk(double velocity, double acceleration, double limit, double acceleration_limit) {
  const double speed = math::abs(velocity);
  const double square = math::square(acceleration);
  if ((velocity > 0.0) == (acceleration > 0.0)) return square / (limit - speed);
  const double turning = (square - math::square(acceleration_limit)) / speed;
  return greater(square / (limit + speed), turning);
}

// `reach`: the move's distance or change of velocity, in ticks.
Task task_of(const StartMotion& start, double reach, const AxisLimits& limits, double tick_s) {
  constexpr double kPerAcceleration = 1024.0;
  constexpr double kPerReach = 4096.0;
  const double tick_2 = tick_s * tick_s;
  const double velocity = start.velocity * tick_s;
  const double acceleration = start.acceleration * tick_2;
  const double limit = limits.velocity * tick_s;
  const AccelerationPair pair{limits.acceleration * tick_2, limits.deceleration * tick_2};
  const double strongest = greater(greater(pair.acceleration, pair.deceleration), math::abs(acceleration));
  const double farthest = greater(greater(reach, math::abs(velocity)), math::abs(acceleration));
  const double enough = lesser(kPerAcceleration * strongest, kPerReach * farthest);
  const double least = keeping_jerk(velocity, acceleration, limit, pair.acceleration);
  const double jerk = lesser(limits.jerk * tick_2 * tick_s, greater(least, enough));
  // Cruising stays this much below its limit, so that a track's rounding over a million ticks does not pass it.
  constexpr double kBelowLimit = 1.0 - 128.0 * DBL_EPSILON;
  const double cruise = math::abs(velocity) > limit ? 0.0 : math::abs(velocity);
  return Task{jerk, greater(kBelowLimit * limit, cruise) / jerk,
              AccelerationPair{pair.acceleration / jerk, pair.deceleration / jerk},
              Motion{0.0, velocity / jerk, acceleration / jerk}};
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
    out.segments[i] = Segment{phase.ticks, phase.acceleration * task.jerk, phase.jerk * task.jerk};
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
    const Task task = task_of(start, math::abs(distance), limits, tick_s);
    solve(task, distance / task.jerk, phases);
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
    append_transition(task.start, velocity * tick_s / task.jerk, task.limits, phases);
    status = write(task, phases, tick_s, plan);
    Motion motion{0.0, task.start.velocity, task.start.acceleration};
    for (uint32_t i = 0; i < phases.count; ++i) motion = advanced(motion, phases.phase[i].jerk, phases.phase[i].ticks);
    plan.distance = motion.position * task.jerk;
  }
  if (status.ok()) out = plan;
  return status;
}

}  // namespace stillpoint
