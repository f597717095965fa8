// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/curve.hpp"

#include "shaper/base/math.hpp"
#include "shaper/profile/track.hpp"

namespace stillpoint {

namespace {

constexpr int kTimeBits = 64;    // of ticks
constexpr int kLengthBits = 80;  // of a part's length and of the position in its table: their product has 96
constexpr uint32_t kNoSpan = UINT32_MAX;

static_assert(2 * kLengthBits - 64 == kTrackFractionBits && kTimeBits == 64);

double to_counts(const Wide& value) { return to_double(value, kTrackFractionBits); }
Wide whole_ticks_of(uint32_t ticks) { return Wide{0, ticks}; }
uint32_t ceiling(Wide time) { return static_cast<uint32_t>(time.high) + (time.low != 0 ? 1U : 0U); }

// To the last of its 96 bits: the quotient of doubles, and that of what it leaves.
Wide quotient(const Wide& value, const Wide& time) {
  const double ticks = to_double(time, kTimeBits);
  const Wide first = wide_from_double(to_counts(value) / ticks, kTrackFractionBits);
  const Wide left = value - fixed_product(first, time);
  return first + wide_from_double(to_counts(left) / ticks, kTrackFractionBits);
}

// Spans a tick of a table over `time`.
Wide rate_of(const ProfileTable& table, const Wide& time) {
  return quotient(Wide{0, uint64_t{table.spans} << 32}, time);
}

Wide to_length(const Wide& counts) { return shifted_right(counts, kTrackFractionBits - kLengthBits); }

// A ramp this short is none: at the one tick that may lie in it the position differs by 2^-12 of a tick's way.
constexpr double kShortestTicks = 1.0 / 1024.0;

[[gnu::noinline]] Wide half_time(const CurvePiece& piece) {
  return piece.duration_ticks < kShortestTicks ? Wide{0, 0} : wide_from_double(piece.duration_ticks, kTimeBits - 1);
}

// Half the durations of the ramps; what is left of the move is the cruise.
struct Ramps {
  Wide up;
  Wide down;
};

Ramps ramps_of(const Plan& plan) {
  const Wide none{0, 0};
  const Wide half = shifted_right(whole_ticks_of(plan.duration_ticks), 1);
  Ramps ramps{half_time(plan.pieces[0]), half_time(plan.pieces[plan.piece_count - 1])};
  if (plan.piece_count == kMaxPieces) return ramps;
  if (ramps.down == none) ramps.up = half;
  if (ramps.up != half) ramps.down = half - ramps.up;
  return ramps;
}

// A ramp over `half` twice, run from or (backwards) towards `base`.
CurvePart ramp_part(const CurvePiece& piece, const Wide& half, const Wide& velocity, const Wide& base) {
  const Wide rate = rate_of(*piece.table, shifted_left(half, 1));
  const Wide length = to_length(fixed_product(velocity, half));
  if (piece.reversed) return CurvePart{piece.table, 0, Wide{0, 0}, -rate, base, -length};
  return CurvePart{piece.table, 0, Wide{0, 0}, rate, base, length};
}

uint32_t make_ramps(const Plan& plan, Wide start, Wide target, CurvePart (&parts)[kMaxPieces]) {
  const uint32_t end = plan.duration_ticks;
  const Wide whole = whole_ticks_of(end);
  const Ramps half = ramps_of(plan);
  const Wide velocity = quotient(target - start, whole - (half.up + half.down));
  const uint32_t line_tick = ceiling(shifted_left(half.up, 1));
  const uint32_t down_tick = ceiling(whole - shifted_left(half.down, 1));
  uint32_t count = 0;
  if (line_tick != 0) parts[count++] = ramp_part(plan.pieces[0], half.up, velocity, start);
  if (line_tick < down_tick) {
    const Wide position = start + fixed_product(velocity, whole_ticks_of(line_tick) - half.up);
    parts[count++] = CurvePart{nullptr, line_tick, position, velocity, Wide{0, 0}, Wide{0, 0}};
  }
  if (down_tick < end) {
    CurvePart& down = parts[count++];
    down = ramp_part(plan.pieces[plan.piece_count - 1], half.down, velocity, target);
    down.first_tick = down_tick;
    down.local = down.rate * Wide::from_int(static_cast<int64_t>(down_tick) - end);
  }
  return count;
}

uint32_t part_at(const CurvePart* parts, uint32_t count, uint32_t tick) {
  uint32_t part = 0;
  while (part + 1 < count && parts[part + 1].first_tick <= tick) ++part;
  return part;
}

Wide local_at(const CurvePart& part, uint32_t tick) {
  return part.local + part.rate * Wide::from_int(tick - part.first_tick);
}

// Where in which span a time lies. Rounding may put it a little outside the table.
struct Place {
  uint32_t span;
  uint64_t fraction;
};

Place place_of(const ProfileTable& table, const Wide& local) {
  if (is_negative(local)) return Place{0, 0};
  const uint32_t span = static_cast<uint32_t>(local.high >> 32);
  if (span >= table.spans) return Place{table.spans - 1, UINT64_MAX};
  return Place{span, (local.high << 32) | (local.low >> 32)};
}

}  // namespace

uint32_t make_curve(const Plan& plan, Signal start, Signal target, CurvePart (&parts)[kMaxPieces]) {
  const Wide from = standing(start).difference[0];
  const Wide to = standing(target).difference[0];
  if (plan.piece_count != 1) return make_ramps(plan, from, to, parts);
  const ProfileTable* table = plan.pieces[0].table;
  parts[0] =
      CurvePart{table, 0, Wide{0, 0}, rate_of(*table, whole_ticks_of(plan.duration_ticks)), from, to_length(to - from)};
  return 1;
}

Differences differences_on(const CurvePart* parts, uint32_t count, uint32_t tick) {
  const CurvePart& part = parts[part_at(parts, count, tick)];
  CurveWalk walk;
  const Wide position = walk.begin_at(parts, count, tick);
  if (part.table == nullptr) return Differences{{position, part.rate}};
  const Place place = place_of(*part.table, local_at(part, tick));
  int64_t coefficients[2 * kMaxTableOrder + 2];
  part.table->polynomial(place.span, coefficients);
  const double x = math::ldexp(static_cast<double>(place.fraction), -64);
  double slope = 0.0;
  double bend = 0.0;
  for (uint32_t k = part.table->degree(); k >= 1; --k) {
    const double c = k * static_cast<double>(coefficients[k]);
    if (k >= 2) bend = bend * x + (k - 1) * c;
    slope = slope * x + c;
  }
  const double rate = to_counts(part.rate);
  const double scale = math::ldexp(to_double(part.length, kLengthBits), -kTableFractionBits) * rate;
  const double acceleration = bend * scale * rate;
  return Differences{{position, wide_from_double(slope * scale + acceleration / 2.0, kTrackFractionBits),
                      wide_from_double(acceleration, kTrackFractionBits)}};
}

Wide CurveWalk::position(const CurvePart& part) {
  if (part.table == nullptr) return local_;
  const Place place = place_of(*part.table, local_);
  if (place.span != span_) {
    span_ = place.span;
    part.table->polynomial(span_, coefficients_);
  }
  constexpr int kLift = kLengthBits - kTableFractionBits;
  uint32_t k = part.table->degree();
  Wide sum = shifted_left(Wide::from_int(coefficients_[k]), kLift);
  while (k-- > 0) {
    sum = times_fraction(sum, place.fraction);
    sum += shifted_left(Wide::from_int(coefficients_[k]), kLift);
  }
  return part.base + fixed_product(part.length, sum);
}

Wide CurveWalk::begin_at(const CurvePart* parts, uint32_t count, uint32_t tick) {
  part_ = part_at(parts, count, tick);
  local_ = local_at(parts[part_], tick);
  span_ = kNoSpan;
  return position(parts[part_]);
}

Wide CurveWalk::next(const CurvePart* parts, uint32_t count, uint32_t tick) {
  if (part_ + 1 < count && parts[part_ + 1].first_tick == tick) return begin_at(parts, count, tick);
  local_ += parts[part_].rate;
  return position(parts[part_]);
}

}  // namespace stillpoint
