// SPDX-License-Identifier: Apache-2.0
// Shapers as they run: a cascade of short FIR stages, each with its zeros on the sampled poles of the mode.
// Background context; doubles.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/status.hpp"
#include "shaper/shaping/meanwhile.hpp"
#include "shaper/shaping/mode.hpp"
#include "shaper/shaping/response.hpp"
#include "shaper/shaping/shaper_spec.hpp"

namespace stillpoint {

constexpr int kGainFractionBits = 30;
constexpr int32_t kUnityGain = INT32_C(1) << kGainFractionBits;

struct Tap {
  uint32_t delay_ticks;
  int32_t gain;  // times 2^-30
};

// Taps [first_tap, first_tap + tap_count) of the design; their gains sum to kUnityGain exactly, so a stage at rest
// hands on its input to the last bit. The first has delay 0, the others come in pairs (an impulse between two ticks is
// split over both), so the count is odd and at least 3. Delays do not fall; the last is the stage's length.
struct Stage {
  uint32_t first_tap;
  uint32_t tap_count;
};

constexpr uint32_t kMaxStageTicks = UINT32_C(1) << 20;

struct ShaperDesign {
  static constexpr size_t kMaxStages = stillpoint::kMaxStages;
  static constexpr size_t kMaxTaps = stillpoint::kMaxTaps;

  uint32_t stage_count;  // 0: pass-through
  uint32_t tap_count;
  Stage stages[kMaxStages];
  Tap taps[kMaxTaps];

  // Ticks from a change of the input until the output has followed completely.
  uint32_t length_ticks() const;
  // Signals of delay line that running it takes.
  uint32_t line_length() const;
  // Centroid of the impulse response, ticks: what the shaper delays a slow movement by.
  double delay_ticks() const;
  // Sum of |gain|, multiplied over the stages: the most by which any peak of the input, of its velocity or of its
  // acceleration can grow. 1 where no gain is negative; else a bound, exact for a single stage.
  double peak_gain() const;
  // The gains as impulses at whole ticks, for response.hpp.
  Cascade cascade() const;
};

// How well the ticks hold a shaper of humps or of several zeros.
struct PlacementReport {
  // The largest miss of a hump or a band edge against the continuous shaper: 1 is 1e-3 of V in a hump (or 2 % of the
  // tolerance, if that is less), 1 % in an edge. Above 0.1 cycles a tick only what is higher or narrower counts.
  double band_miss;
  bool has_negative_tap;  // although the continuous shaper has no negative impulse
};

// Adds the stages of a shaper to the design (several modes: call it once a mode). ZV, ZVD, ZVDD, ZVDDD and CV are a
// cascade of ZV stages with taps at 0, k and k+1 ticks that put a zero exactly on a sampled pole
// exp((-zeta w +- j wd) dt); MZV, EI, UM-ZV and custom trains are one stage. See prototype.hpp for the continuous
// shapers, grid.hpp for their way onto the ticks, grid_fit.hpp for what is kept of their bands there.
// Gains are rounded to 2^-30, the first takes what is left to one; that moves the transfer at the pole by at most 2^-31
// sum |1 - p^-d|, below 4e-9 for ZV at zeta up to 0.3 and 1e-7 for the longest.
// Refuses, naming the nearest value accepted: an invalid spec or tick; a frequency whose highest zero would pass
// 0.49/dt, or so high that the ticks cannot hold the train, or so low that a stage would outlast kMaxStageTicks; a
// tolerance that has no damped shaper; impulse times of a custom train that outlast a stage or, kNotAvailable, that the
// ticks cannot hold; a design without room. `design` is then unchanged. `report` may be null.
// Cost: ZV one exp, one sqrt, three sin or cos; the bounds of the others at prototype.hpp and grid_fit.hpp. Measured
// (tests/bench, Cortex-M4 with doubles in software), millions of instructions, the worst of 11, 37.3 and 90 Hz with
// damping 0, 0.1 and 0.3: ZV 0.03, MZV 0.1, UM-ZV 0.3, ZVD 13, CV1 45, ZVDDD 51, ZVDD 57, EI 68, CV2 91, CV3 533, EI2
// 625, CV4 887, EI3 1358 (a refusal): 16 s at 168 MHz and two cycles an instruction; the least of nine is 7 to 59. So
// `meanwhile` is called at least every 43 million. Stack: 17 KB.
Status add_shaper(const ShaperSpec& spec, double tick_s, ShaperDesign& design, PlacementReport* report = nullptr,
                  const Meanwhile& meanwhile = {});

// The same with the defaults of ShaperSpec.
Status add_shaper(ShaperKind kind, const Mode& mode, double tick_s, ShaperDesign& design);

// A frequency, as low as can be said without designing for each, whose shaper a line of `line_length` signals can hold:
// the lowest one itself for ZV to ZVDDD, at most a tick a stage above it for the others. 0 for kNone and for what
// cannot be designed.
double lowest_frequency_hz(const ShaperSpec& spec, double tick_s, size_t line_length);

}  // namespace stillpoint
