// SPDX-License-Identifier: Apache-2.0
// A cascade of FIR stages on the fixed-point signal.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/base/status.hpp"
#include "shaper/shaping/design.hpp"

namespace stillpoint {

// A signal made ready for 32-bit multiplication: high * 2^32 + low with low in [-2^31, 2^31), so that either half meets
// a gain in one signed multiply-accumulate.
struct alignas(8) LineSample {
  int32_t low;
  int32_t high;
};

// Runs a design on delay lines in memory that the caller owns. Zero-initialised it passes its input through.
class Shaper {
 public:
  // Takes over the design, its lines in `memory` filled with `position`, so that an axis at rest there stays there.
  // Refuses kLineTooShort with the signals needed and those there; the shaper is then unchanged, the memory too.
  // Cost: `line_length` stores. Whoever owns the shaper.
  Status configure(const ShaperDesign& design, LineSample* memory, size_t capacity, Signal position);

  // As if the input had been `position` for ever.
  void fill(Signal position);

  // Takes the input of this tick, returns the output. No division; per stage one rounding to the nearest LSB, so the
  // output of a stage at rest is its input exactly.
  Signal tick(Signal input);

  const ShaperDesign& design() const { return design_; }

 private:
  // A stage as the tick walks it: a ring that holds the inputs of the last `length` ticks.
  struct Line {
    LineSample* first;
    LineSample* newest;
    uint32_t length;
    const Tap* taps_end;
  };

  ShaperDesign design_ = {};
  Line lines_[ShaperDesign::kMaxStages] = {};
};

}  // namespace stillpoint
