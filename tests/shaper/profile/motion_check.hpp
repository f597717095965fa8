// SPDX-License-Identifier: Apache-2.0
// What a plan from a moving state promises, checked by integrating it apart; and states of motion to plan from.
#pragma once

#include <cmath>

#include "shaper/profile/plan_from.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

inline AxisLimits scaled(const AxisLimits& l, double by) {
  return AxisLimits{l.velocity * by, l.acceleration * by, l.deceleration * by, l.jerk * by, l.deceleration_jerk * by};
}

// The velocity once the acceleration has been let go of as fast as the jerk limits allow, found phase by phase.
inline double let_go_velocity(const StartMotion& start, const AxisLimits& limits) {
  double v = start.velocity;
  double energy = start.acceleration * start.acceleration / 2.0;
  const double sign = start.acceleration < 0.0 ? -1.0 : 1.0;
  if (v * sign < 0.0) {
    const double to_zero = std::fmin(energy, limits.braking_jerk() * std::fabs(v));
    v += sign * to_zero / limits.braking_jerk();
    energy -= to_zero;
  }
  return v + sign * energy / limits.jerk;
}

// A state from which every limit can be kept: neither is passed, and none will be however the jerk is used.
inline bool can_keep_limits(const StartMotion& start, const AxisLimits& limits) {
  const double sign = start.velocity < 0.0 ? -1.0 : 1.0;
  const double speed = sign * start.velocity;
  const double a = sign * start.acceleration;
  if (speed > limits.velocity || std::fabs(let_go_velocity(start, limits)) > limits.velocity) return false;
  if (a >= 0.0) return a <= limits.acceleration;
  if (-a > limits.deceleration) return false;
  // It turns round while it lets go: then what was deceleration is acceleration.
  return a * a / 2.0 <= limits.braking_jerk() * speed + limits.acceleration * limits.acceleration / 2.0;
}

// The worst of a plan, relative to the limits, and its ends relative to the path.
struct MotionReport {
  double start_error = 0.0;       // of the first acceleration
  double continuity_error = 0.0;  // of acceleration where segments meet
  double duration_error = 0.0;
  double end_position_error = 0.0;
  double end_velocity_error = 0.0;
  double end_acceleration_error = 0.0;
  double velocity_excess = -1.0;
  double acceleration_excess = -1.0;
  double jerk_excess = -1.0;

  bool arrives(double tolerance) const {
    return start_error <= tolerance && continuity_error <= tolerance && duration_error <= tolerance &&
           end_position_error <= tolerance && end_velocity_error <= tolerance && end_acceleration_error <= tolerance;
  }
  bool within(double tolerance) const {
    return velocity_excess <= tolerance && acceleration_excess <= tolerance && jerk_excess <= tolerance;
  }
};

inline void raise(double& worst, long double value) {
  // A NaN is the worst of all.
  if (!(value <= static_cast<long double>(worst))) worst = static_cast<double>(value);
}

struct Instant {
  long double position;
  long double velocity;
  long double acceleration;
};

inline Instant instant_in(const Instant& at, const Segment& segment, long double ticks) {
  const long double a = segment.acceleration;
  const long double j = segment.jerk;
  return Instant{at.position + ticks * (at.velocity + ticks * (a / 2 + ticks * j / 6)),
                 at.velocity + ticks * (a + ticks * j / 2), a + ticks * j};
}

// The state `ticks` after the start.
inline Instant instant_at(const Plan& plan, long double ticks) {
  Instant at{0.0L, plan.start_velocity, 0.0L};
  for (uint32_t i = 0; i < plan.segment_count && ticks > 0; ++i) {
    const long double part = std::fmin(ticks, static_cast<long double>(plan.segments[i].duration_ticks));
    at = instant_in(at, plan.segments[i], part);
    ticks -= part;
  }
  return at;
}

// The limits in ticks. Where the velocity is zero but for rounding its sign says nothing, and the larger limit holds.
struct TickLimits {
  long double velocity;
  long double acceleration;
  long double deceleration;
  long double jerk;
  long double braking_jerk;
  TickLimits(const AxisLimits& limits, double tick_s)
      : velocity(static_cast<long double>(limits.velocity) * tick_s),
        acceleration(static_cast<long double>(limits.acceleration) * tick_s * tick_s),
        deceleration(static_cast<long double>(limits.deceleration) * tick_s * tick_s),
        jerk(static_cast<long double>(limits.jerk) * tick_s * tick_s * tick_s),
        braking_jerk(static_cast<long double>(limits.braking_jerk()) * tick_s * tick_s * tick_s) {}
  void check(const Instant& at, long double rounding, MotionReport& report) const {
    const bool turns = std::fabs(at.velocity) <= rounding;
    const bool along = (at.velocity > 0) == (at.acceleration > 0);
    const long double limit = turns ? std::fmax(acceleration, deceleration) : (along ? acceleration : deceleration);
    raise(report.velocity_excess, std::fabs(at.velocity) / velocity - 1);
    raise(report.acceleration_excess, std::fabs(at.acceleration) / limit - 1);
  }
  // Inside of a segment; where the sign of velocity or acceleration says nothing, the larger jerk holds.
  void check_jerk(const Instant& at, double value, long double rounding, long double steepest,
                  MotionReport& report) const {
    const bool unclear = std::fabs(at.velocity) <= rounding || std::fabs(at.acceleration) <= 1e-9L * steepest;
    const bool along = (at.velocity > 0) == (at.acceleration > 0);
    const long double limit = unclear ? std::fmax(jerk, braking_jerk) : (along ? jerk : braking_jerk);
    raise(report.jerk_excess, std::fabs(value) / limit - 1);
  }
};

inline long double hardest_of(const Plan& plan, long double start) {
  long double hardest = std::fabs(start);
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& s = plan.segments[i];
    hardest = std::fmax(hardest, std::fabs(s.acceleration + static_cast<long double>(s.jerk) * s.duration_ticks));
  }
  return hardest;
}

// `samples` of a segment, both ends with them, and the extremum of its velocity.
inline void check_limits(const Segment& segment, const Instant& begin, const TickLimits& limits, int samples,
                         long double& fastest, MotionReport& report) {
  const long double ticks = segment.duration_ticks;
  const long double steepest = std::fabs(segment.acceleration) + std::fabs(segment.jerk) * ticks;
  for (int k = 0; k <= samples; ++k) {
    const Instant inside = instant_in(begin, segment, ticks * k / samples);
    fastest = std::fmax(fastest, std::fabs(inside.velocity));
    limits.check(inside, 1e-9L * fastest, report);
    limits.check_jerk(inside, segment.jerk, 1e-9L * fastest, steepest, report);
  }
  const long double turn = segment.jerk != 0.0 ? -begin.acceleration / segment.jerk : -1;
  if (turn > 0 && turn < ticks) limits.check(instant_in(begin, segment, turn), 1e-9L * fastest, report);
}

inline MotionReport report_on(const Plan& plan, const StartMotion& start, double end_velocity, const AxisLimits& limits,
                              double tick_s, int samples) {
  MotionReport report;
  const TickLimits in_ticks(limits, tick_s);
  Instant at{0.0L, plan.start_velocity, static_cast<long double>(start.acceleration) * tick_s * tick_s};
  long double fastest = std::fabs(at.velocity);
  const long double hardest = hardest_of(plan, at.acceleration);
  long double duration = 0;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& segment = plan.segments[i];
    const long double step = std::fabs(segment.acceleration - at.acceleration);
    raise(i == 0 ? report.start_error : report.continuity_error, hardest > 0 ? step / hardest : 0);
    check_limits(segment, at, in_ticks, samples, fastest, report);
    at = instant_in(at, segment, segment.duration_ticks);
    duration += segment.duration_ticks;
  }
  if (plan.segment_count == 0) return report;
  const long double end = static_cast<long double>(end_velocity) * tick_s;
  raise(report.start_error,
        std::fabs(plan.start_velocity - static_cast<long double>(start.velocity) * tick_s) / fastest);
  raise(report.duration_error, std::fabs(duration - plan.duration_ticks) / plan.duration_ticks);
  raise(report.end_position_error, std::fabs(at.position - plan.distance) / (fastest * duration));
  raise(report.end_velocity_error, std::fabs(at.velocity - end) / fastest);
  raise(report.end_acceleration_error, hardest > 0 ? std::fabs(at.acceleration) / hardest : 0);
  return report;
}

// How many times the jerks are apart. The little velocity that is left at a turning point, of which the smaller jerk
// makes a long way, is the difference of what the larger one works with: digits are lost in proportion.
inline double jerk_spread(const AxisLimits& limits) {
  return limits.larger_jerk() / std::fmin(limits.jerk, limits.braking_jerk());
}

// Limits over `decades` decades of proportion to each other, in a unit of its own.
inline AxisLimits random_limits(Random& random, double decades) {
  const auto factor = [&] { return std::pow(10.0, random.between(-decades, decades) / 2.0); };
  const double unit = std::pow(10.0, random.between(-4.0, 4.0));
  const double acceleration = 10.0 * unit * factor();
  const bool equal = random.next() % 2 == 0;
  AxisLimits limits{unit * factor(), acceleration, equal ? acceleration : acceleration * factor(),
                    100.0 * unit * factor()};
  if (random.next() % 2 == 0) limits.deceleration_jerk = limits.jerk * std::pow(10.0, random.between(-3.0, 3.0));
  return limits;
}

inline StartMotion random_start(Random& random, const AxisLimits& limits) {
  for (int i = 0; i < 1000; ++i) {
    const double strongest = std::fmax(limits.acceleration, limits.deceleration);
    const double by_jerk = std::fmin(strongest, 2.0 * std::sqrt(limits.velocity * limits.larger_jerk()));
    const StartMotion start{limits.velocity * random.between(-1.0, 1.0), by_jerk * random.between(-1.0, 1.0)};
    if (can_keep_limits(start, limits)) return start;
  }
  return StartMotion{0.0, 0.0};
}

// Half of the targets anywhere, half near where stopping at once would lead, beyond it and before.
inline double random_distance(Random& random, const StartMotion& start, const AxisLimits& limits, double tick_s) {
  Plan stop{};
  if (!plan_to_velocity(start, 0.0, limits, tick_s, stop).ok()) return 0.0;
  const double time = limits.velocity / limits.acceleration + limits.acceleration / limits.jerk;
  const double sign = random.next() % 2 == 0 ? 1.0 : -1.0;
  if (random.next() % 2 == 0) return sign * limits.velocity * time * std::pow(10.0, random.between(-6.0, 2.0));
  return stop.distance * (1.0 + sign * std::pow(10.0, random.between(-9.0, 0.3)));
}

}  // namespace stillpoint::testing
