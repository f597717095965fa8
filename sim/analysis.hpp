// SPDX-License-Identifier: Apache-2.0
// What a shaper leaves of a vibration, from its impulses alone. Long double throughout.
#pragma once

#include <cstdint>
#include <vector>

#include "shaper/shaping/design.hpp"
#include "shaper/shaping/mode.hpp"
#include "sim/spec.hpp"

namespace stillpoint::sim {

struct ExactImpulse {
  long double time_s;
  long double amplitude;
};

// The shaper as the literature has it, its impulses anywhere between the ticks, multiplied out. Empty for kNone.
// Throws a Refusal where it has no solution.
std::vector<ExactImpulse> continuous_impulses(const SpecifiedShaper& spec);

// Residual vibration ratio V(w, zeta) = exp(-zeta w t_n) |sum A_i exp((zeta w + j wd) t_i)| of Park (1).
long double residual(const std::vector<ExactImpulse>& impulses, const Mode& mode);

// The same for the quantised stages as they run: V of a convolution is the product of its stages' V (Park (3)).
long double residual_on_grid(const ShaperDesign& design, const Mode& mode, double tick_s);

// The contiguous band around mode.frequency_hz in which the stages, at the mode's damping, leave at most `tolerance`,
// as ratios to it. It ends at half the tick rate at the latest, and is empty (1, 1) where the mode itself is above.
// `from`: where the search for either edge begins.
struct Band {
  double low_ratio;
  double high_ratio;
};
Band tolerated_band(const ShaperDesign& design, const Mode& mode, double tolerance, double tick_s,
                    const Band& from = {1.0, 1.0});
// The same from the outermost zeros on: humps between them are the shaper's own, within a thousandth of the tolerance.
Band tolerated_band(const ShaperDesign& design, const SpecifiedShaper& spec, double tick_s);

struct ImpulseTap {
  uint32_t delay_ticks;
  long double gain;
};

// The stages multiplied out, delays rising. Stops and returns nothing above `most` taps.
std::vector<ImpulseTap> multiplied_out(const ShaperDesign& design, size_t most);

// Largest factor by which any input's peak can grow: the sum of |gain|. 1 for shapers of positive impulses. (Above
// kMostTaps the product of the stages' sums, an upper bound.)
constexpr size_t kMostTaps = 4096;
long double peak_gain(const ShaperDesign& design);

// The input's frequency, up to half the tick rate, that comes out largest: 1 at 0 Hz for shapers of positive impulses;
// what others excite above it. 4,096 frequencies are looked at.
struct FrequencyGain {
  double gain;
  double frequency_hz;
};
FrequencyGain highest_gain(const ShaperDesign& design, double tick_s);

}  // namespace stillpoint::sim
