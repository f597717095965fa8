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

// Of the samples' halves, the high ones as seen from the newest: positions wrap at the end of their range, the distance
// between two samples does not. The gains sum to one, so nothing else changes, not even in the last bit.
struct Sums {
  int32_t newest;
  int64_t low;
  int64_t high;

  void add(int32_t gain, const LineSample& sample) {
    low += product(sample.low, gain);
    high += product(static_cast<int32_t>(static_cast<uint32_t>(sample.high) - static_cast<uint32_t>(newest)), gain);
  }
  Signal rounded() const {
    return static_cast<Signal>((uint64_t{static_cast<uint32_t>(newest)} << 32) +
                               (static_cast<uint64_t>(high) << (32 - kGainFractionBits)) +
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

Status too_short(size_t needed, size_t capacity) {
  return refuse(Error::kLineTooShort, Quantity::kDelay, static_cast<double>(needed), static_cast<double>(capacity));
}

}  // namespace

Status Shaper::configure(const ShaperDesign& design, LineSample* memory, size_t capacity, Signal position) {
  const size_t needed = memory_needed(design);
  if (needed > capacity) return too_short(needed, capacity);
  LineSample* next = memory;
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    const Tap* const taps = design.taps + design.stages[i].first_tap;
    const uint32_t count = design.stages[i].tap_count;
    *next++ = LineSample{0, static_cast<int32_t>(taps[count - 1].delay_ticks + 1)};
    *next++ = LineSample{static_cast<int32_t>(1 + count), taps[0].gain};
    for (uint32_t k = 1; k < count; ++k) *next++ = LineSample{static_cast<int32_t>(taps[k].delay_ticks), taps[k].gain};
  }
  memory_ = memory;
  lines_ = next;
  stage_count_ = design.stage_count;
  length_ticks_ = design.length_ticks();
  fill(position);
  return kOk;
}

Status Shaper::configure(const Shaper& other, LineSample* memory, size_t capacity, Signal position) {
  const size_t needed = other.memory_used();
  if (needed > capacity) return too_short(needed, capacity);
  const auto walked = static_cast<size_t>(other.lines_ - other.memory_);
  for (size_t i = 0; i < walked; ++i) memory[i] = other.memory_[i];
  memory_ = memory;
  lines_ = memory + walked;
  stage_count_ = other.stage_count_;
  length_ticks_ = other.length_ticks_;
  fill(position);
  return kOk;
}

void Shaper::fill(Signal position) {
  const LineSample sample = split(position);
  LineSample* const end = lines_ + length_ticks_ + stage_count_;
  for (LineSample* line = lines_; line != end; ++line) *line = sample;
}

Signal Shaper::tick(Signal input) {
  LineSample* head = memory_;
  LineSample* first = lines_;
  for (LineSample* const end = lines_; head != end;) {
    const auto length = static_cast<uint32_t>(head->high);
    uint32_t place = static_cast<uint32_t>(head->low) + 1;
    if (place == length) place = 0;
    head->low = static_cast<int32_t>(place);
    const LineSample* tap = head + 1;
    head += tap->low;
    LineSample* const newest = first + place;
    const LineSample now = split(input);
    *newest = now;
    // The sums of the halves apart, each one multiply-accumulate a tap: |low| * sum |gain| stays below 2^63 for gains
    // that sum to less than 4 in magnitude. The first tap is always the input itself, the others come in pairs.
    Sums sums{now.high, (INT64_C(1) << (kGainFractionBits - 1)) + product(now.low, tap->high), 0};
    ++tap;
    do {
      sums.add(tap[0].high, *older(newest, static_cast<uint32_t>(tap[0].low), first, length));
      sums.add(tap[1].high, *older(newest, static_cast<uint32_t>(tap[1].low), first, length));
      tap += 2;
    } while (tap != head);
    first += length;
    input = sums.rounded();
  }
  return input;
}

bool Shaper::averages() const {
  for (const LineSample* head = memory_; head != lines_;) {
    const LineSample* const end = head + head[1].low;
    while (++head != end) {
      if (head->high < 0) return false;
    }
  }
  return true;
}

ShaperDesign Shaper::design() const {
  ShaperDesign design{};
  for (const LineSample* tap = memory_; tap != lines_;) {
    ++tap;
    const auto count = static_cast<uint32_t>(tap->low) - 1;
    design.stages[design.stage_count++] = Stage{design.tap_count, count};
    for (uint32_t k = 0; k < count; ++k, ++tap) {
      design.taps[design.tap_count++] = Tap{k == 0 ? 0 : static_cast<uint32_t>(tap->low), tap->high};
    }
  }
  return design;
}

}  // namespace stillpoint
