// SPDX-License-Identifier: Apache-2.0
// Random moves from random states, each judged whole. A function answers what is wrong, or nullptr; the tests run a few
// of them, plan_from_long_run as many as asked for.
#pragma once

#include <cmath>

#include "shaper/profile/plan_from.hpp"
#include "shaper/profile/track.hpp"
#include "tests/shaper/profile/lattice_optimum.hpp"
#include "tests/shaper/profile/motion_check.hpp"
#include "tests/shaper/profile/moving_stream_check.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

struct MoveTask {
  StartMotion start;
  double distance;
  AxisLimits limits;
};

inline MoveTask scaled(const MoveTask& task, double by) {
  return MoveTask{StartMotion{task.start.velocity * by, task.start.acceleration * by}, task.distance * by,
                  scaled(task.limits, by)};
}

inline Status planned_from(const MoveTask& task, double tick_s, Plan& plan) {
  return plan_from(task.start, task.distance, task.limits, tick_s, plan);
}

inline MoveTask random_task(Random& random, double decades, double tick_s) {
  MoveTask task{};
  task.limits = random_limits(random, decades);
  task.start = random_start(random, task.limits);
  task.distance = random_distance(random, task.start, task.limits, tick_s);
  return task;
}

// The same ticks in every unit. A duration that rounding could lift above a whole number of ticks may take one more.
inline bool is_scale_free(const MoveTask& task, double tick_s, const Plan& plan) {
  for (const double by : {1e3, 1e6, 1e-6, 1e-3 / 7.0}) {
    Plan other{};
    if (!planned_from(scaled(task, by), tick_s, other).ok()) return false;
    if (std::fabs(other.optimum_ticks - plan.optimum_ticks) > 1e-6 * plan.optimum_ticks) return false;
    const bool near_whole = std::fabs(plan.optimum_ticks - std::round(plan.optimum_ticks)) <= 1e-6 * plan.optimum_ticks;
    if (other.duration_ticks != plan.duration_ticks && !near_whole) return false;
  }
  return true;
}

// What is left of an optimum is an optimum. The tolerance: a state is rounded to 1e-16 of the move, and the time of a
// move of that length is the cube root. So near the end that less of a jerk limit is used: less than a tick, as said.
inline bool stays_optimal(Random& random, const MoveTask& task, double tick_s, const Plan& plan) {
  const long double passed = static_cast<long double>(plan.optimum_ticks) * random.between(0.0, 0.99);
  const Instant at = instant_at(plan, passed);
  MoveTask rest = task;
  rest.start =
      StartMotion{static_cast<double>(at.velocity) / tick_s, static_cast<double>(at.acceleration) / (tick_s * tick_s)};
  rest.distance = static_cast<double>(task.distance - at.position);
  Plan other{};
  if (!planned_from(rest, tick_s, other).ok()) return false;
  const long double difference = std::fabs(other.optimum_ticks + passed - plan.optimum_ticks);
  const double farthest = std::fmax(std::fabs(rest.distance), static_cast<double>(std::fabs(at.velocity)));
  if (task.limits.larger_jerk() * tick_s * tick_s * tick_s > 4096.0 * farthest) return difference < 1.0L;
  return difference <= 1e-4L * std::cbrt(jerk_spread(task.limits)) * plan.optimum_ticks;
}

// Over `decades` decades of the limits' proportions.
inline const char* fault_of_move(Random& random, double decades) {
  const double tick_s = std::pow(10.0, random.between(-4.0, -2.0));
  const MoveTask task = random_task(random, decades, tick_s);
  Plan plan{};
  const Status status = planned_from(task, tick_s, plan);
  const bool extreme = decades > 4.0;  // some last for years, and their roundings drift for as long
  if (!status.ok()) return extreme && status.quantity == Quantity::kDuration ? nullptr : "refused";
  if (plan.duration_ticks != std::ceil(plan.optimum_ticks * (1.0 - 0x1p-48))) return "ticks";
  const MotionReport report = report_on(plan, task.start, 0.0, task.limits, tick_s, 12);
  if (!report.arrives(extreme ? 1e-8 : 1e-13)) return "arrival or continuity";
  if (!report.within(extreme ? 1e-8 : 1e-13)) return "limits";
  if (extreme) return nullptr;
  if (!is_scale_free(task, tick_s, plan)) return "another unit, another plan";
  if (!stays_optimal(random, task, tick_s, plan)) return "not optimal on the way";
  return nullptr;
}

inline const char* fault_of_velocity_change(Random& random, double decades) {
  constexpr double kTick = 1e-3;
  const AxisLimits limits = random_limits(random, decades);
  const StartMotion start = random_start(random, limits);
  const double velocity = limits.velocity * random.between(-1.0, 1.0);
  Plan plan{};
  if (!plan_to_velocity(start, velocity, limits, kTick, plan).ok()) return "refused";
  const MotionReport report = report_on(plan, start, velocity, limits, kTick, 12);
  if (!report.arrives(1e-12)) return "arrival or continuity";
  return report.within(1e-12) ? nullptr : "limits";
}

// From up to three times outside the limits: back without passing more than the start forces, then as ever.
inline const char* fault_of_outside_start(Random& random) {
  constexpr double kTick = 1e-3;
  MoveTask task = random_task(random, 3.0, kTick);
  const AxisLimits& l = task.limits;
  const double strongest = std::fmax(l.acceleration, l.deceleration);
  task.start.velocity = l.velocity * random.between(-3.0, 3.0);
  const double reached = std::fmin(strongest, 2.0 * std::sqrt(l.velocity * std::fmin(l.jerk, l.braking_jerk())));
  task.start.acceleration = reached * random.between(-3.0, 3.0);
  const double a = std::fabs(task.start.acceleration);
  const double let_go = let_go_velocity(task.start, l);
  Plan plan{};
  if (!planned_from(task, kTick, plan).ok()) return "refused";
  if (!report_on(plan, task.start, 0.0, l, kTick, 1).arrives(1e-12)) return "arrival or continuity";
  const Peaks peaks = peaks_of(plan, kTick);
  const double fastest = std::fmax(l.velocity, std::fmax(std::fabs(task.start.velocity), std::fabs(let_go)));
  if (peaks.velocity > fastest * (1.0 + 1e-12)) return "velocity passed by more than the start forces";
  if (peaks.acceleration > std::fmax(strongest, a) * (1.0 + 1e-12)) return "acceleration grows outside";
  if (a > strongest && plan.segments[0].jerk * task.start.acceleration >= 0.0) return "acceleration does not come back";
  return peaks.jerk <= l.larger_jerk() * (1.0 + 1e-12) ? nullptr : "jerk";
}

// In counts over eight decades, sampled by a track: every tick of it on the plan, within the limits, and on the target.
inline const char* fault_of_stream(Random& random) {
  constexpr double kTick = 1e-3;
  for (int tries = 0; tries < 1000; ++tries) {
    MoveTask task = random_task(random, 2.0, kTick);
    task = scaled(task, std::pow(10.0, random.between(1.0, 8.0)) / task.limits.velocity);
    task.distance = std::round(task.distance);
    Plan plan{};
    if (!planned_from(task, kTick, plan).ok()) return "refused";
    if (std::fabs(task.distance) > 1e9 || plan.duration_ticks > 3000 || task.limits.larger_jerk() > 1e18) continue;
    const auto start = static_cast<int32_t>(random.integer(-1000000000, 1000000000));
    const Signal target = signal_from_counts(start + static_cast<int32_t>(task.distance));
    Track track{};
    Track::make(plan, signal_from_counts(start), target, track);
    Sampler sampler;
    sampler.begin(track);
    MovingStreamCheck check(signal_from_counts(start), task.limits, kTick);
    for (uint32_t tick = 1; tick <= plan.duration_ticks + 3; ++tick) {
      const Signal signal = sampler.tick();
      check.next(signal);
      if (tick >= plan.duration_ticks && signal != target) return "not on the target";
      if (tick % 16 != 0 || tick > plan.duration_ticks) continue;
      const long double counts = static_cast<long double>(signal) / 4294967296.0L - start;
      const long double error = std::fabs(counts - instant_at(plan, tick).position);
      if (error > 1e-9L + 1e-12L * tick * static_cast<long double>(task.limits.velocity * kTick)) return "off the plan";
    }
    return check.within() ? nullptr : "limits of the stream";
  }
  return "no move found";
}

// In whole counts, from one to all the range, planned and integrated; half of them from rest.
inline const char* fault_of_plan_in_counts(Random& random) {
  constexpr double kTick = 1e-3;
  MoveTask task{};
  task.limits = random_limits(random, 2.0);
  task.limits = scaled(task.limits, std::pow(10.0, random.between(1.0, 8.0)) / task.limits.velocity);
  if (random.next() % 2 == 0) task.start = random_start(random, task.limits);
  const double sign = random.next() % 2 == 0 ? 1.0 : -1.0;
  task.distance = sign * std::floor(std::pow(2.0, random.between(0.0, 31.0)));
  Plan plan{};
  const Status status = planned_from(task, kTick, plan);
  // A million seconds for the one move, at a few counts a second, is refused by name.
  if (!status.ok()) return status.quantity == Quantity::kDuration ? nullptr : "refused";
  if (plan.duration_ticks != std::ceil(plan.optimum_ticks * (1.0 - 0x1p-48))) return "ticks";
  const MotionReport report = report_on(plan, task.start, 0.0, task.limits, kTick, 1);
  if (!report.arrives(1e-12)) return "arrival or continuity";
  return report.within(1e-12) ? nullptr : "limits";
}

// Against the search over all sequences of jerk.
struct Comparison {
  long states = 0;
  long braking = 0;  // of them: braking, the target up to a fifth of the way beyond the stop
  long same_ticks = 0;
  long slower = 0;  // by more than rounding: none
  double worst_ticks = -1e300;
};

inline void compare(Random& random, const LatticeOptimum& optimum, const LatticeLimits& lattice, long states,
                    Comparison& result) {
  const AxisLimits limits{lattice.velocity_2 / 2.0, static_cast<double>(lattice.acceleration),
                          static_cast<double>(lattice.deceleration), static_cast<double>(lattice.jerk),
                          static_cast<double>(lattice.braking_jerk)};
  const int strongest = lattice.acceleration > lattice.deceleration ? lattice.acceleration : lattice.deceleration;
  for (long found = 0, tries = 0; found < states && tries < 1000 * states; ++tries) {
    LatticeState state{static_cast<int>(random.integer(-strongest, strongest)),
                       static_cast<int>(random.integer(-lattice.velocity_2, lattice.velocity_2)), 0};
    const StartMotion start{state.velocity_2 / 2.0, static_cast<double>(state.acceleration)};
    Plan stop{};
    if (!plan_to_velocity(start, 0.0, limits, 1.0, stop).ok()) continue;
    const bool near_stop = random.next() % 2 == 0;
    const double distance = near_stop ? stop.distance * random.between(1.0, 1.2) : random.between(-1.0, 1.0) * 300.0;
    state.position_6 = -static_cast<int>(std::lround(6.0 * distance));
    const int ticks = optimum.ticks(state);
    if (ticks == LatticeOptimum::kUnreached) continue;
    ++found;
    if (near_stop && state.velocity_2 * state.acceleration < 0) ++result.braking;
    Plan plan{};
    const MoveTask task =
        scaled(MoveTask{start, state.position_6 / -6.0, limits}, std::pow(10.0, random.between(-6, 6)));
    const bool planned = planned_from(task, 1.0, plan).ok();
    if (!planned || plan.optimum_ticks > ticks + 1e-4 || plan.duration_ticks > static_cast<uint32_t>(ticks) + 1)
      ++result.slower;
    if (plan.duration_ticks == static_cast<uint32_t>(ticks)) ++result.same_ticks;
    raise(result.worst_ticks, plan.optimum_ticks - ticks);
  }
  result.states += states;
}

}  // namespace stillpoint::testing
