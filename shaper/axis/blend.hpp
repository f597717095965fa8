// SPDX-License-Identifier: Apache-2.0
// From one shaper's output to another's, gradually.
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"

namespace stillpoint {

// from + (to - from) w, w from 0 to 1 in the least jerk there is between two rests: its third difference is +1, -1, -1,
// +1 over q ticks each, times 1 / (2 q^3). These numbers sum to exactly 2 q^3; with q a power of two the division is a
// shift, w has no rounding of its own and both ends are exact bit for bit. Its n-th differences stay within 1 / (2 q),
// 1 / (2 q^2), 1 / (2 q^3). Tick context, and the background that rehearses it.
class BlendRamp {
 public:
  static constexpr uint32_t kMaxOrder = 10;  // 2 q^3 then still fits 32 bits

  static constexpr uint32_t ticks(uint32_t order) { return UINT32_C(4) << order; }

  // q = 2^order. The first `tick` is the first with w above 0; w is 1 from the last but two on.
  void begin(uint32_t order);
  // One rounding to the nearest LSB.
  Signal tick(Signal from, Signal to);
  bool done() const { return tick_ == ticks(order_); }

 private:
  uint32_t order_ = 0;
  uint32_t tick_ = 0;
  uint32_t weight_ = 0;  // times 2 q^3
  int32_t slope_ = 0;
  int32_t curvature_ = 0;
};

}  // namespace stillpoint
