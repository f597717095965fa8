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

// Runs a design in memory that the caller owns. Zero-initialised it passes its input through.
//
// The memory begins with what the tick walks, a LineSample (8 bytes, on every machine) a stage and a tap; the delay
// lines follow in the order of the stages. So a shaper takes what its design needs, and no more.
class Shaper {
 public:
  // LineSamples of memory that running the design takes.
  static size_t memory_needed(const ShaperDesign& design) { return overhead(design) + design.line_length(); }
  // Signals of delay line that memory of `capacity` leaves to as many stages and taps as the design has; what
  // lowest_frequency_hz asks for.
  static size_t line_room(const ShaperDesign& design, size_t capacity) {
    return capacity > overhead(design) ? capacity - overhead(design) : 0;
  }

  // Takes over the design, its lines filled with `position`, so that an axis at rest there stays there. `memory` is the
  // shaper's until the next success. Refuses kLineTooShort with the LineSamples needed and those there; the shaper is
  // then unchanged, the memory too. Cost: `memory_needed` stores. Whoever owns the shaper.
  Status configure(const ShaperDesign& design, LineSample* memory, size_t capacity, Signal position);
  // The same with the design that another shaper runs, in other memory.
  Status configure(const Shaper& other, LineSample* memory, size_t capacity, Signal position);

  // As if the input had been `position` for ever.
  void fill(Signal position);

  // Takes the input of this tick, returns the output. No division; per stage one rounding to the nearest LSB, so the
  // output of a stage at rest is its input exactly. The input may wrap at the end of the position range; over the
  // shaper's length it must stay within 2^31 counts.
  Signal tick(Signal input);

  uint32_t stage_count() const { return stage_count_; }
  uint32_t length_ticks() const { return length_ticks_; }
  size_t memory_used() const { return static_cast<size_t>(lines_ - memory_) + length_ticks_ + stage_count_; }
  // The output is a mean of the input's past: no gain is negative.
  bool averages() const;
  // What it runs, put together again: 700 bytes. Does not read what the tick writes.
  ShaperDesign design() const;

 private:
  static size_t overhead(const ShaperDesign& design) { return size_t{design.stage_count} + design.tap_count; }

  // Of each stage a head (low: place of the newest sample in its line; high: signals of line) and its taps (low: delay;
  // high: gain). The delay of the first is 0, so its place holds the LineSamples of the whole stage.
  LineSample* memory_ = nullptr;
  LineSample* lines_ = nullptr;
  uint32_t stage_count_ = 0;
  uint32_t length_ticks_ = 0;
};

}  // namespace stillpoint
