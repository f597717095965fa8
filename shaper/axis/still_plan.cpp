// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/still_plan.hpp"

#include "shaper/axis/jerk_sequence.hpp"
#include "shaper/axis/still_search.hpp"
#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

// Where the plain move lies in the sequence at first: it speeds up in the first round. What is left free around it may
// grow into swings of the acceleration: before the cruise, in it, before slowing down and while doing so.
struct Place {
  size_t cruise;  // part
  size_t down;    // round
};
constexpr Place kPlaces[kStillStarts] = {{3, 1}, {3, 2}, {3, 3}, {7, 2}, {7, 3}, {11, 3}};
constexpr double kLongCruise = 0.25;  // of the plain duration

JerkSequence written(const Plan& plain, const Place& place) {
  const size_t down = place.down;
  JerkSequence sequence{};
  bool slowing = false;
  for (size_t i = 0; i < plain.segment_count; ++i) {
    const Segment& segment = plain.segments[i];
    const double t = segment.duration_ticks / plain.duration_ticks;
    const bool forward = plain.distance > 0.0;
    const bool rises = (segment.jerk > 0.0) == forward;
    if (segment.jerk == 0.0) {
      if (segment.acceleration == 0.0) {
        sequence.length[place.cruise] = t;
        continue;
      }
      sequence.length[(segment.acceleration > 0.0) == forward ? 1 : 4 * down + 3] = t;
      continue;
    }
    if (rises) sequence.length[slowing ? 4 * (down + 1) : 0] = t;
    if (!rises && !slowing) {
      const bool ends = segment.acceleration != 0.0;
      sequence.length[ends ? 2 : 4 * down + 2] = t;
      slowing = !ends;
    }
  }
  return sequence;
}

// False if there are too many parts.
bool write_plan(const JerkSequence& sequence, const Plan& plain, double jerk, Plan& out) {
  Plan plan{};
  plan.distance = plain.distance;
  double acceleration = 0.0;
  double ticks = 0.0;
  for (size_t k = 0; k < kJerkParts; ++k) {
    const double t = sequence.length[k] * plain.optimum_ticks;
    if (t <= 0.0) continue;
    const double j = plain.distance > 0.0 ? jerk_sign(k) * jerk : -jerk_sign(k) * jerk;
    const bool goes_on = plan.segment_count > 0 && plan.segments[plan.segment_count - 1].jerk == j;
    if (plan.segment_count + 1 >= kMaxSegments && !goes_on) return false;
    if (goes_on) {
      plan.segments[plan.segment_count - 1].duration_ticks += t;
    } else {
      plan.segments[plan.segment_count++] = Segment{t, acceleration, j};
    }
    acceleration += j * t;
    ticks += t;
  }
  plan.optimum_ticks = ticks;
  plan.duration_ticks = whole_ticks(ticks);
  if (plan.duration_ticks > ticks) plan.segments[plan.segment_count++] = Segment{plan.duration_ticks - ticks, 0.0, 0.0};
  out = plan;
  return true;
}

bool keeps(const Plan& plan, const AxisLimits& limits, double tick_s) {
  const double sign = plan.distance > 0.0 ? 1.0 : -1.0;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const double acceleration = sign * plan.segments[i].acceleration / (tick_s * tick_s);
    if (acceleration > limits.acceleration || -acceleration > limits.deceleration) return false;
  }
  return peaks_of(plan, tick_s).velocity <= limits.velocity;
}

// The smaller jerk, and room for what is kept to 1e-12 of other units than the limit's.
AxisLimits usable(const AxisLimits& limits) {
  constexpr double kRoom = 1.0 - 1e-9;
  const double jerk = limits.braking_jerk() < limits.jerk ? limits.braking_jerk() : limits.jerk;
  return AxisLimits{limits.velocity * kRoom, limits.acceleration * kRoom, limits.deceleration * kRoom, jerk, 0.0};
}

StillLimits scaled(const AxisLimits& limits, double distance, double unit_ticks, double tick_s) {
  const double unit = unit_ticks * tick_s;
  const double per_jerk = 1.0 / (limits.jerk * unit);
  return StillLimits{limits.velocity * per_jerk / unit, limits.acceleration * per_jerk, limits.deceleration * per_jerk,
                     math::abs(distance) * per_jerk / (unit * unit)};
}

Status check_modes(const Mode* modes, size_t mode_count) {
  if (mode_count == 0 || mode_count > kMostStillModes)
    return refuse(Error::kNotAvailable, Quantity::kStages, static_cast<double>(mode_count), kMostStillModes);
  for (size_t m = 0; m < mode_count; ++m) {
    const Status status = modes[m].validate();
    if (!status.ok()) return status;
  }
  return kOk;
}

}  // namespace

Status plan_still(double distance, const AxisLimits& limits, const Mode* modes, size_t mode_count, double tick_s,
                  Plan& out) {
  const AxisLimits used = usable(limits);
  Plan plain{};
  Status status = plan_rest_to_rest(distance, used, ProfileKind::kSCurve, tick_s, plain);
  if (status.ok()) status = check_modes(modes, mode_count);
  if (!status.ok()) return status;
  if (distance == 0.0) {
    out = plain;
    return kOk;
  }
  bool found = false;
  Plan best{};
  for (int i = 0; i < kStillStarts; ++i) {
    const JerkSequence start = written(plain, kPlaces[i]);
    StillSearch search(start, plain.optimum_ticks, scaled(used, distance, plain.optimum_ticks, tick_s));
    for (size_t m = 0; m < mode_count; ++m) search.add_mode(modes[m], tick_s);
    if (start.length[kPlaces[i].cruise] > kLongCruise) search.hold(kPlaces[i].cruise);
    Plan plan{};
    const double jerk = used.jerk * tick_s * tick_s * tick_s;
    if (!search.run() || !write_plan(search.sequence(), plain, jerk, plan) || !keeps(plan, limits, tick_s)) continue;
    if (!found || plan.optimum_ticks < best.optimum_ticks) best = plan;
    found = true;
  }
  if (!found) return refuse(Error::kNotAvailable, Quantity::kFrequency, modes[0].frequency_hz);
  out = best;
  return kOk;
}

}  // namespace stillpoint
