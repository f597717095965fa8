// SPDX-License-Identifier: Apache-2.0
// From gains in double to the integers that run. Constexpr.
#pragma once

#include "shaper/shaping/design.hpp"
#include "shaper/shaping/zv.hpp"

namespace stillpoint {

// |gain| below 2.
constexpr int32_t quantised(double gain) { return static_cast<int32_t>(math::floor(gain * kUnityGain + 0.5)); }

// Adds a stage; the first gain takes what the rounding of the others leaves to one.
constexpr void append_stage(const Impulse* taps, uint32_t count, ShaperDesign& design) {
  const uint32_t first = design.tap_count;
  design.stages[design.stage_count++] = Stage{first, count};
  int64_t rest = kUnityGain;  // on the way as low or as high as the gains' sum
  for (uint32_t i = 0; i < count; ++i) {
    const int32_t gain = quantised(taps[i].amplitude);
    if (i > 0) rest -= gain;
    design.taps[design.tap_count++] = Tap{static_cast<uint32_t>(taps[i].time), gain};
  }
  design.taps[first].gain = static_cast<int32_t>(rest);
}

// The stages of a cascade on the ticks. The caller has made sure of room.
constexpr void append_quantised(const Cascade& taps, ShaperDesign& design) {
  for (uint32_t i = 0; i < taps.part_count; ++i) {
    append_stage(taps.impulses + taps.parts[i].first, taps.parts[i].count, design);
  }
}

// A ZV shaper at compile time, so that it lies in flash: `constexpr ShaperDesign kShaper = zv_design({11.0, 0.11},
// 1e-3);`. The mode and tick must be ones that add_shaper accepts; the same bits as its.
constexpr ShaperDesign zv_design(const Mode& mode, double tick_s) {
  const ZvTaps zv = zv_taps(mode.frequency_hz * tick_s, mode.damping_ratio);
  const double delay = zv.delay;
  const Impulse taps[] = {{0.0, zv.gain[0]}, {delay, zv.gain[1]}, {delay + 1.0, zv.gain[2]}};
  ShaperDesign design{};
  append_stage(taps, 3, design);
  return design;
}

}  // namespace stillpoint
