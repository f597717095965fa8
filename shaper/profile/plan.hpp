// SPDX-License-Identifier: Apache-2.0
// A move planned in continuous time: the shortest one that the limits allow, as a list of constant-jerk segments.
// Source: Profiles, S-curve and trapezoid. Background context: floating point, bounded work.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/status.hpp"
#include "shaper/profile/limits.hpp"
#include "shaper/profile/profile_table.hpp"

namespace stillpoint {

// kSin2: acceleration a half sine on each ramp. kPoly5, kPoly7: one polynomial of that degree. kTable: a shape of the
// caller's. kMatched: an S-curve whose segments are fitted to a mode.
enum class ProfileKind : uint8_t { kTrapezoid, kSCurve, kSin2, kPoly5, kPoly7, kTable, kMatched };

struct Plan;
struct ProfileDetail;
using Planner = Status (*)(double distance, const AxisLimits& limits, double tick_s, const ProfileDetail& detail,
                           Plan& out);

// What some kinds need besides the limits.
struct ProfileDetail {
  const ProfileTable* table = nullptr;  // kTable: the shape; must outlive the move
  double frequency_hz = 0.0;            // kMatched: the mode, undamped
  double damping_ratio = 0.0;
  Planner planner = nullptr;  // kMatched: plan_matched, so that an image which never asks for it has none of its code
};

// The others step in acceleration and use no jerk limit.
constexpr bool limits_jerk(ProfileKind kind, const ProfileDetail& detail) {
  if (kind == ProfileKind::kTable) return detail.table != nullptr && detail.table->limits_jerk();
  return kind != ProfileKind::kTrapezoid;
}

// One stretch of constant jerk. Units: the plan's position unit and ticks.
struct Segment {
  double duration_ticks;
  double acceleration;  // at its start, unit/tick^2
  double jerk;          // unit/tick^3
};

// A table run through once, or a straight line. Units: the plan's position unit and ticks.
struct CurvePiece {
  const ProfileTable* table;  // null: the line
  bool reversed;              // mirrored in time and direction: a ramp down instead of up
  double duration_ticks;
  double length;  // signed
};

constexpr size_t kMaxPieces = 3;  // ramp, cruise, ramp

// How a kMatched plan is put together; see matched.hpp. Times in ticks.
enum class MatchedForm : uint8_t { kNone, kRamps, kVelocity, kShifted };
struct BoxPair {
  double box[2];
};
struct MatchedShape {
  void (*write)(Plan& plan, uint32_t duration_ticks);  // its segments; null: the plan is not matched
  MatchedForm form;
  double half;      // from the base to its repetition, at the optimum
  double decay;     // how much of it is repeated
  BoxPair ramp[2];  // up and down: whose convolution is the base's ramp
};

constexpr size_t kMaxSegments = 16;  // from rest to rest 7, matched 15; see plan_from.hpp for the others
constexpr uint32_t kMaxDurationTicks = UINT32_C(1) << 30;  // 12 days at 1 ms

struct Plan {
  double distance;          // signed, unit
  double start_velocity;    // unit/tick; 0 for a move from rest
  double optimum_ticks;     // duration of the continuous optimum within the limits; ends anywhere between ticks
  uint32_t duration_ticks;  // duration as planned here: whole ticks, at rest on the last
  uint32_t segment_count;
  Segment segments[kMaxSegments];
  uint32_t piece_count;  // not 0: the move is these pieces, and there are no segments
  CurvePiece pieces[kMaxPieces];
  MatchedShape matched;
};

// Largest magnitudes that a plan reaches, unit/s^n.
struct Peaks {
  double velocity;
  double acceleration;
  double jerk;  // 0 for the trapezoid and a cubic table, whose jerk is impulsive
};

// Plans from rest to rest over `distance` (signed, any unit; zero gives an empty plan of 0 ticks) in the least time.
// The continuous optimum T is stretched uniformly to N = ceil(T/dt) ticks (a T that is above a whole number of ticks by
// no more than rounding counts as whole). Scale-free: distance and limits in another unit give the same N. The way up
// keeps acceleration and jerk, the way down deceleration and braking_jerk(); the trapezoid has no jerk limit.
// Refuses distances and limits that are not finite, limits not above zero, a tick not above zero, and a move that would
// take more than kMaxDurationTicks; `out` is then unchanged. Cost: closed form, and where one ramp reaches its
// acceleration limit and the other does not, at most 64 Newton steps. For kSin2 to kTable see curve_plan.hpp, for
// kMatched matched.hpp.
Status plan_rest_to_rest(double distance, const AxisLimits& limits, ProfileKind kind, double tick_s, Plan& out,
                         const ProfileDetail& detail = {});

// Slows the plan down (or speeds it up) uniformly to exactly `duration_ticks`: S_new(k t) = S(t), so velocity changes
// by 1/k, acceleration by 1/k^2, jerk by 1/k^3 (Li 2017, section 3). Refuses 0 ticks for a distance that is not zero,
// and more than kMaxDurationTicks.
Status stretch(Plan& plan, uint32_t duration_ticks);

// The least number of ticks, 1 at least, that `ticks` fit into; above a whole number by no more than rounding counts as
// whole: 1.51 s is 1510 ticks.
uint32_t whole_ticks(double ticks);

Peaks peaks_of(const Plan& plan, double tick_s);

}  // namespace stillpoint
