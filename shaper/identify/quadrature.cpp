// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/quadrature.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kHalfTurn = UINT32_C(1) << 31;
constexpr uint32_t kQuarterTurn = UINT32_C(1) << 30;

// a b / 2^30
int32_t times(int32_t a, int32_t b) { return static_cast<int32_t>((int64_t{a} * b) >> 30); }

// Times 2^30; phase / 2^30 quarter turns.
int32_t sine(uint32_t phase) {
  if (phase + kQuarterTurn > kHalfTurn) phase = kHalfTurn - phase;
  const auto y = static_cast<int32_t>(phase);
  const int32_t square = times(y, y);
  int32_t sum = -5018418 + times(square, 162655);
  sum = 85566142 + times(square, sum);
  sum = -693598253 + times(square, sum);
  sum = 1686629704 + times(square, sum);
  return times(y, sum);
}

}  // namespace

Quadrature quadrature_of(uint32_t phase) {
  return {(sine(phase) + (1 << 14)) >> 15, (sine(phase + kQuarterTurn) + (1 << 14)) >> 15};
}

}  // namespace stillpoint
