// SPDX-License-Identifier: Apache-2.0
// What a sensor answers to a chirp, at several frequencies side by side.
#pragma once

#include <stdint.h>

#include "shaper/base/meanwhile.hpp"
#include "shaper/identify/bin.hpp"
#include "shaper/identify/excitation.hpp"

namespace stillpoint {

// Fixed frequencies, logarithmically apart, each with whole periods in all ticks together: an offset adds nothing.
class ParallelBins {
 public:
  // `low`, `high`: cycles a tick. Fewer than kMostBins where whole periods are not enough.
  void start(double low, double high, uint32_t ticks);

  // Tick. |value| at most 2^27 over 2^21 ticks fits. Cost: 140 instructions a bin on a Cortex-M4.
  void tick(int32_t value);

  uint32_t count() const { return count_; }
  double cycles_a_tick(uint32_t bin) const { return bin_[bin].increment / 4294967296.0; }
  const BinSums& sums(uint32_t bin) const { return bin_[bin].sums; }

 private:
  struct Bin {
    BinSums sums;
    uint32_t phase;
    uint32_t increment;
  };

  Bin bin_[kMostBins];
  uint32_t count_;
};

// The sensor from kQuiet ticks before a chirp until its ringing is over. Not by slices: to follow an arm so slowly that
// its steady answer shows, a chirp's rate would have to stay far below 2 pi zeta^2 f^2, and from 3 to 40 Hz this one's
// is 70 % of that at 11 Hz and zeta 0.1. Transformed as a whole, what the sensor says over what was asked is exact at
// any rate and damping, but for what still rings at the end: two periods of the lowest frequency are waited, which
// leaves 0.06 % of f at 11 Hz and zeta 0.01 from 5 Hz on, nothing to speak of from 0.02 on.
// What it cannot reach: its one amplitude is what the highest frequency's limits allow, so answers far below that are
// weak. From 4 to 40 Hz at 600 m/s^3 (38 um), an accelerometer of 100 ug/sqrt(Hz) and arms of 5 to 20 Hz it is within
// 0.5 % of f and 10 % of zeta in 20 of 20 at zeta 0.05, 14 at 0.2, 5 at 0.3, where a stepped sine is in all
// (sine_campaign 20).
class ChirpBins {
 public:
  static constexpr uint32_t kQuiet = 256;  // ticks that tell the noise, and as many at the end the drift
  static constexpr int32_t kMost = INT32_C(1) << 27;

  // Background. `low`, `high`: cycles a tick.
  void start(const Excitation& chirp, double low, double high);

  // Tick, before the chirp's own, which is to come where `excites`. Values beyond kMost are taken as that.
  void tick(int32_t value);
  bool excites() const { return at_ > kQuiet; }
  bool over() const { return at_ >= kQuiet + ticks_; }

  // Background, once over. Runs the chirp once more to know what was asked. Returns how many answers there are.
  uint32_t answers(Excitation& chirp, double tick_s, BinAnswer* answers, const Meanwhile& meanwhile = {});

  uint32_t progress_percent() const { return at_ / ((kQuiet + ticks_) / 100 + 1); }

 private:
  ParallelBins heard_;
  ParallelBins asked_;
  int64_t before_;  // sums of the quiet ticks, and of their squares
  int64_t squares_;
  int64_t after_;
  uint32_t ticks_;
  uint32_t at_;
  double low_;
  double high_;
};

}  // namespace stillpoint
