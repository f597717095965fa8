// SPDX-License-Identifier: Apache-2.0
// Sine and cosine for a correlation in the tick.
#pragma once

#include <stdint.h>

namespace stillpoint {

struct Quadrature {
  int32_t sine;  // times 2^15, to the nearest but one
  int32_t cosine;
};

// Of phase / 2^32 turns. Tick: 110 instructions on a Cortex-M4.
// Method: the odd polynomial of degree 9 over a quarter turn (Hastings 1955).
Quadrature quadrature_of(uint32_t phase);

}  // namespace stillpoint
