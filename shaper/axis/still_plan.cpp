// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/still_plan.hpp"

#include "shaper/axis/jerk_sequence.hpp"
#include "shaper/axis/still_search.hpp"
#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

// Where a move lies in the sequence at first. What is left free around it may grow into swings of the acceleration:
// before the cruise, in it, before slowing down and while doing so.
struct Place {
  size_t up;      // round
  size_t cruise;  // part
  size_t down;    // round
};

// With what is not kept priced low the search finds its way among more moves; with it priced high it does not stay at
// one that is too short to keep everything.
struct Start {
  Place place;
  double penalty;
};
// Chosen from 18 on 298 random moves: all of them gain 0.01 % on these.
constexpr Start kStarts[] = {{{0, 3, 2}, 300.0}, {{0, 3, 1}, 300.0}, {{0, 11, 3}, 300.0},
                             {{0, 7, 3}, 100.0}, {{0, 7, 2}, 30.0},  {{0, 3, 3}, 100.0}};
constexpr int kPlainStarts = sizeof kStarts / sizeof kStarts[0];
static_assert(kPlainStarts + 1 == kStillStarts, "the contract counts them");
constexpr double kLongCruise = 0.25;  // of the plain duration
constexpr double kHalvesPenalty = 100.0;

void write_move(const Plan& plan, double unit_ticks, const Place& place, JerkSequence& sequence) {
  const double unit = plan.duration_ticks * unit_ticks / plan.optimum_ticks;
  const bool forward = plan.distance > 0.0;
  bool slowing = false;
  for (size_t i = 0; i < plan.segment_count; ++i) {
    const Segment& segment = plan.segments[i];
    const bool rises = (segment.jerk > 0.0) == forward;
    size_t part = 0;
    if (segment.jerk == 0.0 && segment.acceleration == 0.0) {
      part = place.cruise;
    } else if (segment.jerk == 0.0) {
      part = (segment.acceleration > 0.0) == forward ? 4 * place.up + 1 : 4 * place.down + 3;
    } else if (rises) {
      part = slowing ? 4 * (place.down + 1) : 4 * place.up;
    } else {
      slowing = segment.acceleration == 0.0;
      part = slowing ? 4 * place.down + 2 : 4 * place.up + 2;
    }
    sequence.length[part] = segment.duration_ticks / unit;
  }
}

// A move much shorter than a period is but an impulse to the mode. Then there are two, as behind a ZV.
Status write_halves(const Plan& plain, const AxisLimits& limits, const Mode& mode, double tick_s,
                    JerkSequence& sequence) {
  constexpr double kPi = 3.14159265358979323846;
  const double root = math::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio);
  const double part = 1.0 / (1.0 + math::exp(-mode.damping_ratio * kPi / root));
  Plan first{};
  Plan second{};
  Status status = plan_rest_to_rest(part * plain.distance, limits, ProfileKind::kSCurve, tick_s, first);
  if (status.ok()) {
    status = plan_rest_to_rest((1.0 - part) * plain.distance, limits, ProfileKind::kSCurve, tick_s, second);
  }
  if (!status.ok()) return status;
  write_move(first, plain.optimum_ticks, {0, 3, 1}, sequence);
  write_move(second, plain.optimum_ticks, {3, 15, 4}, sequence);
  const double between = 0.5 / (mode.frequency_hz * root * tick_s) - (first.optimum_ticks + second.optimum_ticks) / 2.0;
  sequence.length[9] = between > 0.0 ? between / plain.optimum_ticks : 0.0;
  return status;
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

// The smaller jerk, and room for what is kept to 1e-10 of other units than the limit's.
AxisLimits usable(const AxisLimits& limits) {
  constexpr double kRoom = 1.0 - 1e-9;
  const double jerk = limits.braking_jerk() < limits.jerk ? limits.braking_jerk() : limits.jerk;
  return AxisLimits{limits.velocity * kRoom, limits.acceleration * kRoom, limits.deceleration * kRoom, jerk * kRoom,
                    0.0};
}

StillLimits scaled(const AxisLimits& limits, double distance, double unit_ticks, double tick_s) {
  const double unit = unit_ticks * tick_s;
  const double per_jerk = 1.0 / (limits.jerk * unit);
  return StillLimits{limits.velocity * per_jerk / unit, limits.acceleration * per_jerk, limits.deceleration * per_jerk,
                     math::magnitude(distance) * per_jerk / (unit * unit)};
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
    JerkSequence start{};
    const bool halves = i == kPlainStarts;
    if (halves && plain.optimum_ticks * tick_s * modes[0].frequency_hz > 1.0) continue;
    if (halves && !write_halves(plain, used, modes[0], tick_s, start).ok()) continue;
    if (!halves) write_move(plain, plain.optimum_ticks, kStarts[i].place, start);
    StillSearch search(start, plain.optimum_ticks, scaled(used, distance, plain.optimum_ticks, tick_s),
                       halves ? kHalvesPenalty : kStarts[i].penalty);
    for (size_t m = 0; m < mode_count; ++m) search.add_mode(modes[m], tick_s);
    if (!halves && start.length[kStarts[i].place.cruise] > kLongCruise) search.hold(kStarts[i].place.cruise);
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

Status plan_still_mode(double distance, const AxisLimits& limits, double tick_s, const ProfileDetail& detail,
                       Plan& out) {
  const Mode mode{detail.frequency_hz, detail.damping_ratio};
  return plan_still(distance, limits, &mode, 1, tick_s, out);
}

}  // namespace stillpoint
