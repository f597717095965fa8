// SPDX-License-Identifier: Apache-2.0
// A move's shape as a table: position over time, both normalised, as piecewise Hermite polynomials. Lies in flash.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/status.hpp"

namespace stillpoint {

constexpr int kTableFractionBits = 48;
constexpr int64_t kTableOne = INT64_C(1) << kTableFractionBits;
constexpr int64_t kLargestNode = 16 * kTableOne;  // so that every polynomial between such nodes fits in 64 bits
constexpr uint32_t kMaxTableOrder = 3;
constexpr uint32_t kMaxTableSpans = 65535;

// Largest values of the derivatives of a table over a time of 1, as interpolated. The acceleration is signed along the
// move. An order of 1 has steps of acceleration at its knots, so its jerk (within the spans) promises nothing.
struct TablePeaks {
  double velocity;      // magnitude
  double acceleration;  // upwards
  double deceleration;  // downwards
  double jerk;          // magnitude
};

// `spans` equal spans of time, a knot at each end: (spans + 1) * (order + 1) nodes. A knot's nodes are its position and
// derivatives up to `order`: the k-th is d^k p / dt^k / k!, t in spans and p in whole moves, times 2^48. Between two
// knots runs the one polynomial of degree 2 order + 1 that meets both: continuous in `order` derivatives, and where the
// shape itself is such a polynomial, exactly the shape.
struct ProfileTable {
  uint32_t order;  // 1 cubic, 2 quintic, 3 septic
  uint32_t spans;
  const int64_t* nodes;
  TablePeaks peaks;  // as peaks_of_nodes finds them, or larger

  uint32_t degree() const { return 2 * order + 1; }
  // Order 1 steps in acceleration, as a trapezoid does.
  bool limits_jerk() const { return order > 1; }

  // Refuses, as Quantity::kTable, what is no move from rest at 0 to rest at 1: an order not 1 to 3, 0 spans or more
  // than kMaxTableSpans, no nodes, ends elsewhere or with a velocity or (from order 2 on) an acceleration, nodes beyond
  // kLargestNode, peaks that are not finite and above zero. O(nodes), background.
  Status validate() const;

  // Coefficients of span `span`'s polynomial in its part [0, 1] of time, the constant first, times 2^48: additions
  // only, exact. Tick context.
  void polynomial(uint32_t span, int64_t (&coefficients)[2 * kMaxTableOrder + 2]) const;
};

// The peaks to the last bits, none too small: the extremes of each derivative are sought between the zeros of the next.
// Background: some 10,000 double operations a span; so once, when a table is made, best where it is written.
TablePeaks peaks_of_nodes(const ProfileTable& table);

extern const ProfileTable kQuinticTable;   // 10 x^3 - 15 x^4 + 6 x^5: least jerk
extern const ProfileTable kSepticTable;    // 35 x^4 - 84 x^5 + 70 x^6 - 20 x^7: least snap
extern const ProfileTable kSineRampTable;  // x - sin(pi x) / pi: from rest to twice the mean velocity

}  // namespace stillpoint
