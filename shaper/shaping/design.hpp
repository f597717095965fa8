// SPDX-License-Identifier: Apache-2.0
// Shapers as they run: a cascade of short FIR stages, each with its zeros on the sampled poles of the mode.
// Background context; doubles.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/status.hpp"
#include "shaper/shaping/mode.hpp"

namespace stillpoint {

enum class ShaperKind : uint8_t { kNone, kZv, kZvd };

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
constexpr double kMaxDampingRatio = 0.3;

struct ShaperDesign {
  static constexpr size_t kMaxStages = 8;
  static constexpr size_t kMaxTaps = 24;

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
};

// Adds the stages of a shaper for `mode` to the design (several modes: call it once a mode).
// ZV on the grid is one stage with taps at 0, k and k+1 ticks, k = floor(Td/2/dt), that puts zeros exactly on the
// sampled poles exp((-zeta w +- j wd) dt) (reference: Park 2001 for the continuous shaper); ZVD is the same stage
// twice. Gains are rounded to 2^-30, the first takes what is left to one; that moves the transfer at the pole by at
// most 2^-31 (|1 - p^-k| + |1 - p^-(k+1)|), below 4e-9 for zeta up to 0.3. Refuses, naming the nearest value accepted:
// an invalid mode or tick, a frequency above 0.49/dt or so low that a single stage would outlast kMaxStageTicks,
// damping above 0.3, a design without room; `design` is then unchanged. Cost: one exp, one sqrt, three sin or cos a
// call.
Status add_shaper(ShaperKind kind, const Mode& mode, double tick_s, ShaperDesign& design);

// The lowest frequency whose shaper of this kind a line of `line_length` signals can hold.
double lowest_frequency_hz(ShaperKind kind, double damping_ratio, double tick_s, size_t line_length);

}  // namespace stillpoint
