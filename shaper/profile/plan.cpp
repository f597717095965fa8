// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/plan.hpp"

#include <float.h>

#include "shaper/base/math.hpp"
#include "shaper/profile/curve_plan.hpp"

namespace stillpoint {

namespace {

// Of one change of velocity from or to zero; of a move over the distance 1, in ticks.
struct RampLimits {
  double acceleration;
  double jerk;
};

enum : int { kUp, kDown, kRamps };

struct UnitLimits {
  double velocity;
  RampLimits ramp[kRamps];
};

// Jerk up, constant acceleration, jerk down.
struct Ramp {
  double jerk_ticks;
  double constant_ticks;
  [[gnu::noinline]] double ticks() const { return 2.0 * jerk_ticks + constant_ticks; }
};

[[gnu::noinline]] Ramp ramp_to(double velocity, const RampLimits& limits) {
  const double jerk_ticks = limits.acceleration / limits.jerk;
  if (velocity > limits.acceleration * jerk_ticks) return Ramp{jerk_ticks, velocity / limits.acceleration - jerk_ticks};
  return Ramp{math::sqrt(velocity / limits.jerk), 0.0};
}

// The peak velocity where one ramp stays below its acceleration limit, with the jerk `free_jerk`, and the other reaches
// its own: the root s = sqrt(v) of s^4/a + 2 s^3/sqrt(free_jerk) + s^2 a/j = 2. The left side is convex and rises, so
// Newton's steps from the right go down to the root without passing it.
double mixed_peak_velocity(const RampLimits& full, double free_jerk) {
  const double a = full.acceleration;
  const double root_jerk = math::sqrt(free_jerk);
  const double factor[] = {1.0 / a, 2.0 / root_jerk, a / full.jerk, 0.0, -2.0};
  // Each term alone is at most 2 at the root; the tightest of the three is within a factor 3 of it.
  const double by_term[] = {math::sqrt(math::sqrt(2.0 * a)), math::cbrt(root_jerk), math::sqrt(2.0 / factor[2])};
  double s = by_term[0];
  for (int i = 1; i < 3; ++i) {
    if (by_term[i] < s) s = by_term[i];
  }
  for (int step = 0; step < 64; ++step) {
    double value = 0.0;
    double slope = 0.0;
    for (const double coefficient : factor) {
      slope = slope * s + value;
      value = value * s + coefficient;
    }
    const double next = s - value / slope;
    if (!(next < s)) break;
    s = next;
  }
  return s * s;
}

// The peak velocity of the shortest move without a cruise: v (T1(v) + T2(v)) = 2.
double uncruised_peak_velocity(const UnitLimits& limits) {
  double full_velocity[kRamps];  // from which on the acceleration reaches its limit
  for (int i = 0; i < kRamps; ++i)
    full_velocity[i] = limits.ramp[i].acceleration * (limits.ramp[i].acceleration / limits.ramp[i].jerk);
  const int sooner = full_velocity[kDown] < full_velocity[kUp] ? kDown : kUp;
  const RampLimits& first = limits.ramp[sooner];
  const RampLimits& last = limits.ramp[1 - sooner];
  const double ratio = first.jerk / last.jerk;
  // 1/sqrt(j1) + 1/sqrt(j2) = 2/sqrt(j) for the jerk j = j1 mean^2.
  const double mean = 2.0 / (1.0 + math::sqrt(ratio));
  const double by_jerk = math::cbrt(first.jerk * mean * mean / 4.0);
  if (by_jerk <= full_velocity[sooner]) return by_jerk;
  const double p = 1.0 / first.acceleration + 1.0 / last.acceleration;
  const double q = (first.acceleration + last.acceleration * ratio) / first.jerk;
  const double with_both = 4.0 / (q + math::sqrt(q * q + 8.0 * p));
  if (with_both >= full_velocity[1 - sooner]) return with_both;
  return mixed_peak_velocity(first, last.jerk);
}

struct Phases {
  Ramp ramp[kRamps];
  double cruise_ticks;
  double ramp_ticks() const { return ramp[kUp].ticks() + ramp[kDown].ticks(); }
  [[gnu::noinline]] double ticks() const { return ramp[kUp].ticks() + cruise_ticks + ramp[kDown].ticks(); }
};

[[gnu::noinline]] Phases phases_at(double velocity, const UnitLimits& limits) {
  return Phases{{ramp_to(velocity, limits.ramp[kUp]), ramp_to(velocity, limits.ramp[kDown])}, 0.0};
}

Phases shortest(const UnitLimits& limits) {
  Phases phases = phases_at(limits.velocity, limits);
  phases.cruise_ticks = 1.0 / limits.velocity - phases.ramp_ticks() / 2.0;
  if (phases.cruise_ticks >= 0.0) return phases;
  return phases_at(uncruised_peak_velocity(limits), limits);
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
[[gnu::noinline]] double moderate_product(double limit, double per_distance, double per_tick) {
  const double product = limit * per_distance * per_tick;
  return product < 1e60 ? product : 1e60;
}
constexpr double kNoJerkLimit = 1e300;  // of a trapezoid: its jerk phases vanish beside any acceleration so kept

void write_segments(Plan& plan, Phases phases, uint32_t duration_ticks) {
  const double factor = duration_ticks / phases.ticks();
  for (Ramp& ramp : phases.ramp) {
    ramp.jerk_ticks *= factor;
    ramp.constant_ticks *= factor;
  }
  const bool cruises = phases.cruise_ticks > 0.0;
  const double velocity = plan.distance / (cruises ? duration_ticks - phases.ramp_ticks() / 2.0 : duration_ticks / 2.0);
  plan.segment_count = 0;
  append_ramp(plan, phases.ramp[kUp], velocity, 1.0);
  if (cruises) plan.segments[plan.segment_count++] = Segment{phases.cruise_ticks * factor, 0.0, 0.0};
  append_ramp(plan, phases.ramp[kDown], velocity, -1.0);
  plan.duration_ticks = duration_ticks;
}

UnitLimits unit_limits(double distance, const AxisLimits& limits, bool jerk_limited, double tick_s) {
  const double per_distance = 1.0 / math::magnitude(distance);
  const double tick_2 = tick_s * tick_s;
  const auto in_unit = [per_distance](double limit, double per_tick) {
    return moderate_product(limit, per_distance, per_tick);
  };
  UnitLimits unit{
      in_unit(limits.velocity, tick_s),
      {{in_unit(limits.acceleration, tick_2), kNoJerkLimit}, {in_unit(limits.deceleration, tick_2), kNoJerkLimit}}};
  if (jerk_limited) {
    unit.ramp[kUp].jerk = in_unit(limits.jerk, tick_2) * tick_s;
    unit.ramp[kDown].jerk = in_unit(limits.braking_jerk(), tick_2) * tick_s;
  }
  return unit;
}

[[gnu::noinline]] void raise(double& peak, double value) {
  if (math::magnitude(value) > peak) peak = math::magnitude(value);
}

}  // namespace

uint32_t whole_ticks(double ticks) {
  constexpr double kRounding = 16.0 * DBL_EPSILON;
  const double least = ticks * (1.0 - kRounding);
  const auto whole = static_cast<uint32_t>(least);
  return whole == 0 || whole < least ? whole + 1 : whole;
}

Status plan_rest_to_rest(double distance, const AxisLimits& limits, ProfileKind kind, double tick_s, Plan& out,
                         const ProfileDetail& detail) {
  Status status = check_finite(Quantity::kDistance, distance);
  if (!status.ok()) return status;
  if (kind > ProfileKind::kMatched || (kind == ProfileKind::kMatched && detail.planner == nullptr))
    return refuse(Error::kNotAvailable, Quantity::kKind, static_cast<double>(kind));
  status = limits.validate(tick_s);
  if (!status.ok()) return status;
  if (distance == 0.0) {
    out = Plan{};
    return kOk;
  }
  if (kind == ProfileKind::kMatched) return detail.planner(distance, limits, tick_s, detail, out);
  if (kind >= ProfileKind::kSin2) return plan_curve(distance, limits, kind, tick_s, detail, out);
  const Phases phases = shortest(unit_limits(distance, limits, kind == ProfileKind::kSCurve, tick_s));
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
  if (plan.matched.write != nullptr) {
    plan.matched.write(plan, duration_ticks);
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
  double per_tick = 1.0;
  double* const all[] = {&peaks.velocity, &peaks.acceleration, &peaks.jerk};
  for (double* const peak : all) *peak /= per_tick *= tick_s;
  return peaks;
}

}  // namespace stillpoint
