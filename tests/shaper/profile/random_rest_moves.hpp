// SPDX-License-Identifier: Apache-2.0
// Random moves from rest to rest, each judged whole against bisection on the peak velocity. A function answers what is
// wrong, or nullptr; the tests run some of them, plan_from_long_run as many as asked for.
#pragma once

#include <cmath>
#include <initializer_list>

#include "shaper/profile/plan.hpp"
#include "tests/shaper/profile/motion_check.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

// The least time from rest to rest by another method than the planner's: bisection, in long double.
struct RestOracle {
  AxisLimits limits;
  bool jerk_limited;

  long double ramp_time(long double v, long double a, long double j) const {
    if (!jerk_limited) return v / a;
    return v >= a * a / j ? v / a + a / j : 2 * std::sqrt(v / j);
  }
  long double ramps_time(long double v) const {
    return ramp_time(v, limits.acceleration, limits.jerk) + ramp_time(v, limits.deceleration, limits.braking_jerk());
  }
  long double duration(long double distance) const {
    long double low = 0;
    long double high = limits.velocity;
    if (high * ramps_time(high) / 2 <= distance) return distance / high + ramps_time(high) / 2;
    for (int i = 0; i < 200; ++i) {
      const long double middle = (low + high) / 2;
      (middle * ramps_time(middle) / 2 <= distance ? low : high) = middle;
    }
    return ramps_time(high);
  }
};

struct RestMove {
  double distance;
  AxisLimits limits;
  ProfileKind kind;
};

inline RestMove scaled(const RestMove& move, double by) {
  return {move.distance * by, scaled(move.limits, by), move.kind};
}

// All classes, in counts: 1 to 2^31; half of the moves with two jerks, a thousand times apart at most.
inline RestMove random_rest_move(Random& random) {
  RestMove move{};
  move.distance = std::pow(10.0, random.between(0.0, 9.33));
  AxisLimits& l = move.limits;
  l.velocity = move.distance * std::pow(10.0, random.between(-2.0, 3.0));
  l.acceleration = l.velocity * std::pow(10.0, random.between(-1.0, 3.0));
  l.deceleration = random.next() % 2 == 0 ? l.acceleration : l.acceleration * std::pow(10.0, random.between(-2.0, 2.0));
  l.jerk = l.acceleration * std::pow(10.0, random.between(-1, 4));
  if (random.next() % 2 == 0) l.deceleration_jerk = l.jerk * std::pow(10.0, random.between(-3.0, 3.0));
  move.kind = random.next() % 4 == 0 ? ProfileKind::kTrapezoid : ProfileKind::kSCurve;
  return move;
}

// Each ramp within its own limits: the first speeds up, the last slows down.
inline bool ramps_within(const RestMove& move, const Plan& plan, double tick_s) {
  const AxisLimits& l = move.limits;
  const double tick_2 = tick_s * tick_s;
  double velocity = 0.0;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& s = plan.segments[i];
    const double half_way = s.acceleration + s.jerk * s.duration_ticks / 2.0;
    const double end = s.acceleration + s.jerk * s.duration_ticks;
    const double hardest = std::fmax(std::fabs(s.acceleration), std::fabs(end)) / tick_2;
    const double jerk = std::fabs(s.jerk) / (tick_2 * tick_s);
    if (hardest > (half_way >= 0.0 ? l.acceleration : l.deceleration) * (1.0 + 1e-12)) return false;
    if (jerk > (half_way >= 0.0 ? l.jerk : l.braking_jerk()) * (1.0 + 1e-12)) return false;
    velocity += half_way * s.duration_ticks;
    if (velocity / tick_s > l.velocity * (1.0 + 1e-12)) return false;
  }
  return true;
}

inline const char* fault_of_rest_move(Random& random) {
  constexpr double kTick = 1e-3;
  const RestMove move = random_rest_move(random);
  Plan plan{};
  if (!plan_rest_to_rest(move.distance, move.limits, move.kind, kTick, plan).ok()) return "refused";
  const bool s_curve = move.kind == ProfileKind::kSCurve;
  const long double optimum =
      RestOracle{move.limits, s_curve}.duration(move.distance) / static_cast<long double>(kTick);
  if (std::fabs(plan.optimum_ticks / optimum - 1) > 1e-12L) return "not the least time";
  const double least = static_cast<double>(std::ceil(optimum * (1 - 1e-9L)));
  if (plan.duration_ticks < least || plan.duration_ticks > least + 1) return "ticks";
  const MotionReport report = report_on(plan, StartMotion{0.0, 0.0}, 0.0, move.limits, kTick, 1);
  if (report.end_position_error > 1e-12 || report.end_velocity_error > 1e-12 || report.duration_error > 1e-12)
    return "arrival";
  if (!ramps_within(move, plan, kTick)) return "limits";
  for (const double by : {1e-6, 1e-3, 1e3, 1e6}) {
    Plan other{};
    const RestMove in_unit = scaled(move, by);
    if (!plan_rest_to_rest(in_unit.distance, in_unit.limits, move.kind, kTick, other).ok()) return "another unit";
    const bool near_whole = std::fabs(optimum - std::round(optimum)) <= 1e-13L * optimum;
    if (other.duration_ticks != plan.duration_ticks && !near_whole) return "other ticks in another unit";
  }
  return nullptr;
}

}  // namespace stillpoint::testing
