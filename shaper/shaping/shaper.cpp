// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/shaper.hpp"

namespace stillpoint {

namespace {

LineSample split(Signal signal) {
  const uint64_t bits = static_cast<uint64_t>(signal);
  return LineSample{static_cast<int32_t>(static_cast<uint32_t>(bits)),
                    static_cast<int32_t>(static_cast<uint32_t>((bits + UINT64_C(0x80000000)) >> 32))};
}

int64_t product(int32_t half, int32_t gain) { return static_cast<int64_t>(half) * gain; }

struct Sums {
  int64_t low;
  int64_t high;

  void add(int32_t gain, const LineSample& sample) {
    low += product(sample.low, gain);
    high += product(sample.high, gain);
  }
  Signal rounded() const {
    return static_cast<Signal>((static_cast<uint64_t>(high) << (32 - kGainFractionBits)) +
                               static_cast<uint64_t>(low >> kGainFractionBits));
  }
};

// The sample `delay` ticks before `newest` in a ring that begins at `first`. On addresses, since the difference may lie
// before the memory.
const LineSample* older(const LineSample* newest, uint32_t delay, const LineSample* first, uint32_t length) {
  uintptr_t address = reinterpret_cast<uintptr_t>(newest) - delay * sizeof(LineSample);
  if (address < reinterpret_cast<uintptr_t>(first)) address += length * sizeof(LineSample);
  return reinterpret_cast<const LineSample*>(address);
}

}  // namespace

Status Shaper::configure(const ShaperDesign& design, LineSample* memory, size_t capacity, Signal position) {
  const uint32_t needed = design.line_length();
  if (needed > capacity) return refuse(Error::kLineTooShort, Quantity::kDelay, needed, static_cast<double>(capacity));
  design_ = design;
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    const Stage& stage = design.stages[i];
    const uint32_t length = design.taps[stage.first_tap + stage.tap_count - 1].delay_ticks + 1;
    lines_[i] = Line{memory, memory, length, design_.taps + stage.first_tap + stage.tap_count};
    memory += length;
  }
  fill(position);
  return kOk;
}

void Shaper::fill(Signal position) {
  const LineSample sample = split(position);
  for (uint32_t i = 0; i < design_.stage_count; ++i) {
    for (uint32_t k = 0; k < lines_[i].length; ++k) lines_[i].first[k] = sample;
  }
}

Signal Shaper::tick(Signal input) {
  const Tap* tap = design_.taps;
  Line* const end = lines_ + design_.stage_count;
  for (Line* line = lines_; line != end; ++line) {
    LineSample* const first = line->first;
    LineSample* newest = line->newest + 1;
    if (newest == first + line->length) newest = first;
    line->newest = newest;
    const LineSample now = split(input);
    *newest = now;
    // The sums of the halves apart, each one multiply-accumulate a tap: |low| * sum |gain| stays below 2^63 for gains
    // that sum to less than 4 in magnitude. The first tap is always the input itself, the others come in pairs.
    Sums sums{(INT64_C(1) << (kGainFractionBits - 1)) + product(now.low, tap->gain), product(now.high, tap->gain)};
    const uint32_t length = line->length;
    const Tap* const taps_end = line->taps_end;
    ++tap;
    do {
      sums.add(tap[0].gain, *older(newest, tap[0].delay_ticks, first, length));
      sums.add(tap[1].gain, *older(newest, tap[1].delay_ticks, first, length));
      tap += 2;
    } while (tap != taps_end);
    input = sums.rounded();
  }
  return input;
}

}  // namespace stillpoint
