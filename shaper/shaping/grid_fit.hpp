// SPDX-License-Identifier: Apache-2.0
// A shaper on the ticks whose band is that of its prototype. Splitting an impulse over two ticks lowers it at high
// frequencies, so humps and band edges move although the zeros stand where they did: by 1e-5 at 10 Hz and 1 ms, by
// tenths at 100 Hz. The zeros beside the mode are then moved, in frequency and damping, until humps and edges are back.
// Background; doubles.
#pragma once

#include "shaper/shaping/band_targets.hpp"
#include "shaper/shaping/grid.hpp"
#include "shaper/shaping/meanwhile.hpp"

namespace stillpoint {

// Taps in double, and the zeros that they have.
struct GridShaper {
  Cascade taps;  // times in ticks
  uint32_t zero_count;
  Zero zeros[kMaxZeros];
  SplitTicks ticks;  // of a train
  bool is_cascade;
};

// Puts the prototype on the ticks with its own zeros. False where that cannot be solved.
[[nodiscard]] bool place(const Prototype& prototype, double cycles_a_tick, GridShaper& out);

// Moves the zeros of a placed cascade or band shaper, all but one on the mode, where a hump or an edge is off by more
// than it may; where it cannot bring it back it comes as near as it can. Levenberg and Marquardt's descent from at most
// kFitStarts starts, again if impulses move to other ticks, kFitSteps steps in all (with 80 instead of 48, 52 of 12,816
// designs up to 100 Hz would miss instead of 61); what is placed already satisfies two thirds of all designs, four
// steps most. Returns the largest miss left, 1 being what is asked.
constexpr int kFitStarts = 7;
constexpr int kFitStepsAStart = 16;
constexpr int kFitSteps = 48;  // of all
double fit_band(const BandTargets& targets, double damping_ratio, double cycles_a_tick, GridShaper& shaper,
                const Meanwhile& meanwhile = {});

// What fit_band returns, of a shaper as it stands.
double band_miss(const BandTargets& targets, double damping_ratio, double cycles_a_tick, GridShaper& shaper);

}  // namespace stillpoint
