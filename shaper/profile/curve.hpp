// SPDX-License-Identifier: Apache-2.0
// Curve pieces made ready for the tick: a table read at a time that advances by adding.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/base/wide.hpp"
#include "shaper/profile/plan.hpp"

namespace stillpoint {

// Position in counts times 2^96, as a track's. Its time within a table is in spans times 2^96, rounded once for all
// ticks: after 2^30 of them it errs by 2^-67 of a span, and a span of the longest move is 2^63 LSB.
struct CurvePart {
  const ProfileTable* table;  // null: a straight line
  uint32_t first_tick;
  Wide local;   // at the first tick: the time in the table; of a line, the position
  Wide rate;    // of `local`, a tick; below zero where the table is run backwards
  Wide base;    // position where the table begins
  Wide length;  // counts times 2^80: the position is base + length * table(local)
};

struct Differences;

// From rest at `start` to rest at `target`, the plan's pieces; parts without a tick are left out. The plan's own
// doubles give the durations; what follows from them (the velocity of a cruise, where each part begins) is computed to
// 2^-96 of a count, so that the parts meet and the last one ends on the target. Returns how many parts. Background.
uint32_t make_curve(const Plan& plan, Signal start, Signal target, CurvePart (&parts)[kMaxPieces]);

// Position and forward differences of the curve's value and derivatives at a tick. Background.
Differences differences_on(const CurvePart* parts, uint32_t count, uint32_t tick);

// Walks along the parts. Tick context: additions, and for each degree of the polynomial two products of 64 by 64 bits;
// four more for the position.
class CurveWalk {
 public:
  // At any tick before the end; the same bits as one that came there.
  Wide begin_at(const CurvePart* parts, uint32_t count, uint32_t tick);
  // The next tick, which is `tick`.
  Wide next(const CurvePart* parts, uint32_t count, uint32_t tick);

 private:
  Wide position(const CurvePart& part);

  Wide local_ = {};
  int64_t coefficients_[2 * kMaxTableOrder + 2] = {};  // of span_
  uint32_t span_ = 0;
  uint32_t part_ = 0;
};

}  // namespace stillpoint
