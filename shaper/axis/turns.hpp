// SPDX-License-Identifier: Apache-2.0
// A rotary axis, whose places come round again every so many counts. Positions run on and wrap at the end of their
// range; since that is no whole number of turns, a place where the axis reads zero is kept near, and moved on by whole
// turns as it turns.
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"

namespace stillpoint {

enum class Approach : uint8_t { kShortest, kPositive, kNegative };

constexpr uint32_t kMaxModuloCounts = UINT32_C(1) << 30;

struct Turns {
  Signal counts;  // of one, as a Signal; 0: a linear axis
  Signal step;    // whole turns, at most 2^30 counts
  Signal zero;    // a place where the axis reads 0, within 2^31 counts

  // Background. 0 < modulo_counts <= kMaxModuloCounts, or 0.
  void configure(uint32_t modulo_counts) {
    counts = signal_from_counts(static_cast<int32_t>(modulo_counts));
    step = modulo_counts == 0 ? 0 : counts * static_cast<Signal>(kMaxModuloCounts / modulo_counts);
  }

  // Tick: comparisons and additions. Called every tick of a motion of less than 2^30 counts a tick.
  void follow(Signal position) {
    if (step == 0) return;
    const Signal from_zero = wrapping_difference(position, zero);
    if (from_zero >= step) {
      zero = wrapping_sum(zero, step);
    } else if (from_zero < -step) {
      zero = wrapping_difference(zero, step);
    }
  }

  // What the axis reads there: [0, one turn). Background.
  Signal reading(Signal position) const {
    const Signal rest = wrapping_difference(position, zero) % counts;
    return rest < 0 ? rest + counts : rest;
  }

  // How far it is from `position` to the reading `target`, less than a turn either way. Background.
  Signal distance(Signal position, Signal target, Approach approach) const {
    const Signal ahead = target - reading(position);
    if (approach == Approach::kPositive) return ahead < 0 ? ahead + counts : ahead;
    if (approach == Approach::kNegative) return ahead > 0 ? ahead - counts : ahead;
    if (ahead > counts / 2) return ahead - counts;
    return ahead < -(counts / 2) ? ahead + counts : ahead;
  }
};

}  // namespace stillpoint
