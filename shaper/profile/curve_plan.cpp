// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/curve_plan.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

// A ramp over a velocity v takes max(by_acceleration v, by_jerk sqrt(v)).
struct SineRamp {
  double by_acceleration;
  double by_jerk;

  double time(double root_velocity) const {
    return root_velocity * math::greater(by_acceleration * root_velocity, by_jerk);
  }
  // d(v time)/ds for s = sqrt(v)
  [[gnu::noinline]] double slope(double s) const {
    const double linear = by_acceleration * s;
    return s * s * (linear > by_jerk ? 4.0 * linear : 3.0 * by_jerk);
  }
};

// Up and down.
struct SineRamps {
  SineRamp ramp[2];

  explicit SineRamps(const AxisLimits& limits) {
    const double accelerations[] = {limits.acceleration, limits.deceleration};
    const double jerks[] = {limits.jerk, limits.braking_jerk()};
    for (int i = 0; i < 2; ++i) {
      ramp[i].by_acceleration = kSineRampTable.peaks.acceleration / (2.0 * accelerations[i]);
      ramp[i].by_jerk = math::sqrt(kSineRampTable.peaks.jerk / (2.0 * jerks[i]));
    }
  }
  double time(double root_velocity) const { return ramp[0].time(root_velocity) + ramp[1].time(root_velocity); }

  // The root s = sqrt(v) of the peak velocity of the shortest move without a cruise: v (T1(v) + T2(v)) = 2 D, whose
  // left side is convex in s and rises, so that Newton's steps from the right go down to the root without passing it.
  double uncruised(double reach) const {
    double s = 1e300;
    for (const SineRamp& one : ramp) {  // each term alone is at most `reach` at the root
      s = math::lesser(s, math::sqrt(math::sqrt(reach / one.by_acceleration)));
      s = math::lesser(s, math::cbrt(reach / one.by_jerk));
    }
    for (int step = 0; step < 64; ++step) {
      const double next = s - (s * s * time(s) - reach) / (ramp[0].slope(s) + ramp[1].slope(s));
      if (!(next < s)) break;
      s = next;
    }
    return s;
  }
};

// The durations of ramp, cruise, ramp, seconds.
struct Phases {
  double up;
  double cruise;
  double down;
  double time() const { return up + cruise + down; }
};

Phases shortest_sine(double distance, const AxisLimits& limits) {
  const SineRamps ramps(limits);
  double s = math::sqrt(limits.velocity);
  double cruise = distance / limits.velocity - ramps.time(s) / 2.0;
  if (!(cruise > 0.0)) {
    s = math::lesser(ramps.uncruised(2.0 * distance), s);
    cruise = 0.0;
  }
  return Phases{ramps.ramp[0].time(s), cruise, ramps.ramp[1].time(s)};
}

void write_sine(const Phases& phases, Plan& plan) {
  const double factor = plan.duration_ticks / phases.time();
  const double velocity = plan.distance / (plan.duration_ticks - (phases.up + phases.down) * factor / 2.0);
  const auto add = [&](const ProfileTable* table, bool reversed, double time, double mean) {
    const double ticks = time * factor;
    plan.pieces[plan.piece_count++] = CurvePiece{table, reversed, ticks, mean * ticks};
  };
  add(&kSineRampTable, false, phases.up, velocity / 2.0);
  if (phases.cruise > 0.0) add(nullptr, false, phases.cruise, velocity);
  add(&kSineRampTable, true, phases.down, velocity / 2.0);
}

double shortest_table(const ProfileTable& table, double distance, const AxisLimits& limits) {
  const TablePeaks& peaks = table.peaks;
  const double by_velocity = peaks.velocity * distance / limits.velocity;
  const double by_acceleration = math::sqrt(
      distance * math::greater(peaks.acceleration / limits.acceleration, peaks.deceleration / limits.deceleration));
  const double by_jerk = math::cbrt(distance * peaks.jerk / math::lesser(limits.jerk, limits.braking_jerk()));
  const double time = math::greater(by_velocity, by_acceleration);
  return table.limits_jerk() ? math::greater(time, by_jerk) : time;
}

const ProfileTable* table_of(ProfileKind kind, const ProfileDetail& detail) {
  switch (kind) {
    case ProfileKind::kPoly5: return &kQuinticTable;
    case ProfileKind::kPoly7: return &kSepticTable;
    default: return detail.table;
  }
}

}  // namespace

Status plan_curve(double distance, const AxisLimits& limits, ProfileKind kind, double tick_s,
                  const ProfileDetail& detail, Plan& out) {
  const bool ramps = kind == ProfileKind::kSin2;
  const ProfileTable* table = table_of(kind, detail);
  Phases phases{};
  if (ramps) {
    phases = shortest_sine(math::magnitude(distance), limits);
  } else {
    if (table == nullptr) return refuse(Error::kNotAvailable, Quantity::kTable);
    const Status status = table->validate();
    if (!status.ok()) return status;
    phases.cruise = shortest_table(*table, math::magnitude(distance), limits);
  }
  const double ticks = phases.time() / tick_s;
  if (!(ticks <= kMaxDurationTicks))
    return refuse(Error::kAboveMaximum, Quantity::kDuration, ticks * tick_s, kMaxDurationTicks * tick_s);
  out = Plan{};
  out.distance = distance;
  out.optimum_ticks = ticks;
  out.duration_ticks = whole_ticks(ticks);
  if (ramps) {
    write_sine(phases, out);
  } else {
    out.piece_count = 1;
    out.pieces[0] = CurvePiece{table, false, static_cast<double>(out.duration_ticks), distance};
  }
  return kOk;
}

Peaks curve_peaks(const Plan& plan) {
  Peaks peaks{};
  for (uint32_t i = 0; i < plan.piece_count; ++i) {
    const CurvePiece& piece = plan.pieces[i];
    const double velocity = math::magnitude(piece.length) / piece.duration_ticks;
    if (piece.table == nullptr) {
      peaks.velocity = math::greater(peaks.velocity, velocity);
      continue;
    }
    const TablePeaks& table = piece.table->peaks;
    const double acceleration = velocity / piece.duration_ticks;
    peaks.velocity = math::greater(peaks.velocity, table.velocity * velocity);
    peaks.acceleration =
        math::greater(peaks.acceleration, math::greater(table.acceleration, table.deceleration) * acceleration);
    if (piece.table->limits_jerk())
      peaks.jerk = math::greater(peaks.jerk, table.jerk * acceleration / piece.duration_ticks);
  }
  return peaks;
}

}  // namespace stillpoint
