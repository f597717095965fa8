// SPDX-License-Identifier: Apache-2.0
// Division and square root for the tick, where neither the instruction nor the compiler's helper may be.
#pragma once

#include <stdint.h>

namespace stillpoint {

// floor(dividend / divisor), divisor above zero. Any context. Shifts and subtracts, one turn for each bit of the
// quotient: a small one costs little.
constexpr uint64_t divide(uint64_t dividend, uint64_t divisor) {
  if (dividend < divisor) return 0;
  const int shift = __builtin_clzll(divisor) - __builtin_clzll(dividend);
  divisor <<= shift;
  uint64_t quotient = 0;
  for (int turn = 0; turn <= shift; ++turn) {
    quotient <<= 1;
    if (dividend >= divisor) {
      dividend -= divisor;
      ++quotient;
    }
    divisor >>= 1;
  }
  return quotient;
}

// floor(sqrt(square)), square < 2^62. Any context; 31 turns.
[[gnu::noinline]] constexpr uint64_t root(uint64_t square) {
  uint64_t result = 0;
  for (int bit = 30; bit >= 0; --bit) {
    const uint64_t tried = (2 * result + (UINT64_C(1) << bit)) << bit;  // (result + 2^bit)^2 - result^2
    if (tried > square) continue;
    square -= tried;
    result += UINT64_C(1) << bit;
  }
  return result;
}

}  // namespace stillpoint
