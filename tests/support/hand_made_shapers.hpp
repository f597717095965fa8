// SPDX-License-Identifier: Apache-2.0
// Shapers for tests, built by hand: what is tested with them does not depend on what a designer makes of them.
#pragma once

#include "shaper/base/math.hpp"
#include "shaper/shaping/design.hpp"

namespace stillpoint::testing {

// An undamped three-hump EI of 5 % as one stage, in closed form (Singhose 1997): five impulses half a period apart,
// each after the first split linearly over two ticks.
inline ShaperDesign three_hump_ei(double frequency_hz, double tick_s) {
  constexpr double kTolerance = 0.05;
  const double a1 = (1.0 + 3.0 * kTolerance + 2.0 * math::sqrt(2.0 * (kTolerance * kTolerance + kTolerance))) / 16.0;
  const double a2 = (1.0 - kTolerance) / 4.0;
  const double amplitudes[] = {a1, a2, 1.0 - 2.0 * (a1 + a2), a2, a1};
  ShaperDesign design{};
  design.stages[design.stage_count++] = Stage{0, 9};
  design.taps[design.tap_count++] = Tap{0, 0};
  int32_t left = kUnityGain;
  for (int i = 1; i < 5; ++i) {
    const double delay = 0.5 * i / (frequency_hz * tick_s);
    const double before = math::floor(delay);
    const double gain = amplitudes[i] * kUnityGain;
    const int32_t first = static_cast<int32_t>(gain * (1.0 - (delay - before)));
    const int32_t second = static_cast<int32_t>(gain * (delay - before));
    design.taps[design.tap_count++] = Tap{static_cast<uint32_t>(before), first};
    design.taps[design.tap_count++] = Tap{static_cast<uint32_t>(before) + 1, second};
    left -= first + second;
  }
  design.taps[0].gain = left;
  return design;
}

}  // namespace stillpoint::testing
