// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/plan.hpp"

#include <float.h>

#include "shaper/base/math.hpp"
#include "shaper/profile/curve_plan.hpp"
#include "shaper/profile/matched.hpp"

namespace stillpoint {

namespace {

// Limits of a move over the distance 1, in ticks.
struct UnitLimits {
  double velocity;
  double acceleration;
  double deceleration;
  double jerk;
  bool jerk_limited;
};

// One change of velocity from or to zero: jerk up, constant acceleration, jerk down.
struct Ramp {
  double jerk_ticks;
  double constant_ticks;
  double ticks() const { return 2.0 * jerk_ticks + constant_ticks; }
};

Ramp ramp_to(double velocity, double acceleration, const UnitLimits& limits) {
  if (!limits.jerk_limited) return Ramp{0.0, velocity / acceleration};
  const double jerk_ticks = acceleration / limits.jerk;
  if (velocity > acceleration * jerk_ticks) return Ramp{jerk_ticks, velocity / acceleration - jerk_ticks};
  return Ramp{math::sqrt(velocity / limits.jerk), 0.0};
}

// The peak velocity where the stronger ramp stays below its acceleration limit and the weaker one reaches its own: the
// root s = sqrt(v) of s^4/a + 2 s^3/sqrt(j) + s^2 a/j = 2, a the weaker limit. The left side is convex and rises, so
// Newton's steps from the right go down to the root without passing it.
double mixed_peak_velocity(double weaker, double jerk) {
  const double root_jerk = math::sqrt(jerk);
  // Each term alone is at most 2 at the root; the tightest of the three is within a factor 3 of it.
  double s = math::sqrt(math::sqrt(2.0 * weaker));
  const double by_jerk = math::cbrt(root_jerk);
  const double by_both = math::sqrt(2.0 * jerk / weaker);
  if (by_jerk < s) s = by_jerk;
  if (by_both < s) s = by_both;
  for (int step = 0; step < 64; ++step) {
    const double value = s * s * (s * s / weaker + 2.0 * s / root_jerk + weaker / jerk) - 2.0;
    const double slope = s * (4.0 * s * s / weaker + 6.0 * s / root_jerk + 2.0 * weaker / jerk);
    const double next = s - value / slope;
    if (!(next < s)) break;
    s = next;
  }
  return s * s;
}

// The peak velocity of the shortest move without a cruise: v (T1(v) + T2(v)) = 2.
double uncruised_peak_velocity(const UnitLimits& limits) {
  const double a = limits.acceleration;
  const double d = limits.deceleration;
  if (!limits.jerk_limited) return math::sqrt(2.0 / (1.0 / a + 1.0 / d));
  const double weaker = a < d ? a : d;
  const double stronger = a < d ? d : a;
  const double by_jerk = math::cbrt(limits.jerk / 4.0);
  if (by_jerk <= weaker * (weaker / limits.jerk)) return by_jerk;
  const double p = 1.0 / a + 1.0 / d;
  const double q = (a + d) / limits.jerk;
  const double with_both = 4.0 / (q + math::sqrt(q * q + 8.0 * p));
  if (with_both >= stronger * (stronger / limits.jerk)) return with_both;
  return mixed_peak_velocity(weaker, limits.jerk);
}

struct Phases {
  Ramp up;
  Ramp down;
  double cruise_ticks;
  double ticks() const { return up.ticks() + cruise_ticks + down.ticks(); }
};

Phases shortest(const UnitLimits& limits) {
  Phases phases{ramp_to(limits.velocity, limits.acceleration, limits),
                ramp_to(limits.velocity, limits.deceleration, limits), 0.0};
  phases.cruise_ticks = 1.0 / limits.velocity - (phases.up.ticks() + phases.down.ticks()) / 2.0;
  if (phases.cruise_ticks >= 0.0) return phases;
  const double peak = uncruised_peak_velocity(limits);
  return Phases{ramp_to(peak, limits.acceleration, limits), ramp_to(peak, limits.deceleration, limits), 0.0};
}

// A ramp whose jerk phases are this much shorter than a tick is planned with constant acceleration over all its time:
// what is sampled of it stays below the same limits (the jerk limit is then 1024 times the acceleration's, a tick), and
// a jerk of 1e300 never meets the position it would have to be subtracted from again.
constexpr double kShortestJerkTicks = 1.0 / 1024.0;
constexpr double kShortestRampTicks = 1e-9;  // so that a velocity over it is finite

// Appends the segments of one ramp; `sign` is +1 speeding up, -1 slowing down. The jerk follows from the durations, so
// that the segments agree with each other to the last bits whatever rounding the limits went through.
void append_ramp(Plan& plan, const Ramp& ramp, double velocity, double sign) {
  if (ramp.jerk_ticks < kShortestJerkTicks) {
    const double ticks = ramp.ticks() > kShortestRampTicks ? ramp.ticks() : kShortestRampTicks;
    plan.segments[plan.segment_count++] = Segment{ticks, sign * velocity / ticks, 0.0};
    return;
  }
  const double acceleration = sign * velocity / (ramp.jerk_ticks + ramp.constant_ticks);
  const double jerk = acceleration / ramp.jerk_ticks;
  plan.segments[plan.segment_count++] = Segment{ramp.jerk_ticks, 0.0, jerk};
  if (ramp.constant_ticks > 0.0) plan.segments[plan.segment_count++] = Segment{ramp.constant_ticks, acceleration, 0.0};
  plan.segments[plan.segment_count++] = Segment{ramp.jerk_ticks, acceleration, -jerk};
}

// Limits past any use, kept where their products are finite.
double moderate(double limit) { return limit < 1e60 ? limit : 1e60; }

void scale(Ramp& ramp, double factor) {
  ramp.jerk_ticks *= factor;
  ramp.constant_ticks *= factor;
}

void write_segments(Plan& plan, Phases phases, uint32_t duration_ticks) {
  const double factor = duration_ticks / phases.ticks();
  scale(phases.up, factor);
  scale(phases.down, factor);
  const double ramps = phases.up.ticks() + phases.down.ticks();
  const bool cruises = phases.cruise_ticks > 0.0;
  const double velocity = plan.distance / (cruises ? duration_ticks - ramps / 2.0 : duration_ticks / 2.0);
  plan.segment_count = 0;
  append_ramp(plan, phases.up, velocity, 1.0);
  if (cruises) plan.segments[plan.segment_count++] = Segment{phases.cruise_ticks * factor, 0.0, 0.0};
  append_ramp(plan, phases.down, velocity, -1.0);
  plan.duration_ticks = duration_ticks;
}

}  // namespace

uint32_t whole_ticks(double ticks) {
  constexpr double kRounding = 16.0 * DBL_EPSILON;
  const double whole = math::ceil(ticks * (1.0 - kRounding));
  return whole < 1.0 ? 1 : static_cast<uint32_t>(whole);
}

Status plan_rest_to_rest(double distance, const AxisLimits& limits, ProfileKind kind, double tick_s, Plan& out,
                         const ProfileDetail& detail) {
  if (!math::is_finite(distance)) return refuse(Error::kNotFinite, Quantity::kDistance, distance);
  if (kind > ProfileKind::kMatched) return refuse(Error::kNotAvailable, Quantity::kKind, static_cast<double>(kind));
  const Status status = limits.validate();
  if (!status.ok()) return status;
  if (!math::is_finite(tick_s)) return refuse(Error::kNotFinite, Quantity::kTick, tick_s);
  if (!(tick_s > 0.0)) return refuse(Error::kNotPositive, Quantity::kTick, tick_s);
  if (distance == 0.0) {
    out = Plan{};
    return kOk;
  }
  if (kind == ProfileKind::kMatched) return plan_matched(distance, limits, tick_s, detail, out);
  if (kind >= ProfileKind::kSin2) return plan_curve(distance, limits, kind, tick_s, detail, out);
  const double per_distance = 1.0 / math::abs(distance);
  const double tick_2 = tick_s * tick_s;
  const UnitLimits unit{moderate(limits.velocity * per_distance * tick_s),
                        moderate(limits.acceleration * per_distance * tick_2),
                        moderate(limits.deceleration * per_distance * tick_2),
                        moderate(limits.jerk * per_distance * tick_2 * tick_s), kind == ProfileKind::kSCurve};
  const Phases phases = shortest(unit);
  const double ticks = phases.ticks();
  if (!(ticks <= kMaxDurationTicks))
    return refuse(Error::kAboveMaximum, Quantity::kDuration, ticks * tick_s, kMaxDurationTicks * tick_s);
  out.distance = distance;
  out.start_velocity = 0.0;
  out.optimum_ticks = ticks;
  out.piece_count = 0;
  out.matched = {};
  write_segments(out, phases, whole_ticks(ticks));
  return kOk;
}

Status stretch(Plan& plan, uint32_t duration_ticks) {
  if (duration_ticks > kMaxDurationTicks)
    return refuse(Error::kAboveMaximum, Quantity::kDuration, duration_ticks, kMaxDurationTicks);
  if (plan.segment_count + plan.piece_count == 0) {
    plan.duration_ticks = duration_ticks;
    return kOk;
  }
  if (duration_ticks == 0) return refuse(Error::kNotPositive, Quantity::kDuration, 0.0, 1.0);
  if (plan.matched.form != MatchedForm::kNone) {
    write_matched(plan, duration_ticks);
    return kOk;
  }
  const double factor = static_cast<double>(duration_ticks) / plan.duration_ticks;
  const double per_factor = 1.0 / factor;
  plan.start_velocity *= per_factor;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    plan.segments[i].duration_ticks *= factor;
    plan.segments[i].acceleration *= per_factor * per_factor;
    plan.segments[i].jerk *= per_factor * per_factor * per_factor;
  }
  for (uint32_t i = 0; i < plan.piece_count; ++i) plan.pieces[i].duration_ticks *= factor;
  plan.duration_ticks = duration_ticks;
  return kOk;
}

Peaks peaks_of(const Plan& plan, double tick_s) {
  Peaks peaks = curve_peaks(plan);
  double velocity = plan.start_velocity;
  const auto raise = [](double& peak, double value) {
    if (math::abs(value) > peak) peak = math::abs(value);
  };
  raise(peaks.velocity, velocity);
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& segment = plan.segments[i];
    const double end_acceleration = segment.acceleration + segment.jerk * segment.duration_ticks;
    velocity += (segment.acceleration + end_acceleration) / 2.0 * segment.duration_ticks;
    raise(peaks.velocity, velocity);
    raise(peaks.acceleration, segment.acceleration);
    raise(peaks.acceleration, end_acceleration);
    raise(peaks.jerk, segment.jerk);
  }
  peaks.velocity /= tick_s;
  peaks.acceleration /= tick_s * tick_s;
  peaks.jerk /= tick_s * tick_s * tick_s;
  return peaks;
}

}  // namespace stillpoint
