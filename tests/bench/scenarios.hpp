// SPDX-License-Identifier: Apache-2.0
// What is measured, the same on the host and on the chip: the reference move (Li 2017's arm; 1,000,000 counts a unit)
// behind every shaper, and shapers of hand-made stages.
#pragma once

#include "shaper/axis/axis.hpp"
#include "shaper/shaping/design.hpp"

namespace stillpoint::bench {

constexpr double kTickS = 0.001;
constexpr AxisLimits kLimits{1.2e6, 20e6, 20e6, 600e6};
constexpr AxisConfig kAxis{kTickS, kLimits, 100e6, 100e9};
constexpr Move kMove{1700000, ProfileKind::kSCurve, kLimits, 0.0, false};
constexpr Move kMoveBack{0, ProfileKind::kSCurve, kLimits, 0.0, false};
constexpr size_t kCapacity = 1024;

struct Scenario {
  const char* name;
  ShaperKind kind;
  uint32_t mode_count;
};

constexpr Mode kModes[] = {{11.0, 0.11}, {37.0, 0.05}};
constexpr Scenario kScenarios[] = {{"plain", ShaperKind::kNone, 0},      {"ZV", ShaperKind::kZv, 1},
                                   {"ZVD", ShaperKind::kZvd, 1},         {"ZVDD", ShaperKind::kZvdd, 1},
                                   {"ZVDDD", ShaperKind::kZvddd, 1},     {"MZV", ShaperKind::kMzv, 1},
                                   {"EI", ShaperKind::kEi, 1},           {"EI2", ShaperKind::kEi2, 1},
                                   {"EI3", ShaperKind::kEi3, 1},         {"CV1", ShaperKind::kCv1, 1},
                                   {"CV2", ShaperKind::kCv2, 1},         {"CV3", ShaperKind::kCv3, 1},
                                   {"CV4", ShaperKind::kCv4, 1},         {"UM-ZV", ShaperKind::kUmZv, 1},
                                   {"two modes ZV", ShaperKind::kZv, 2}, {"two modes CV4", ShaperKind::kCv4, 2}};

inline Status design_of(const Scenario& scenario, ShaperDesign& design) {
  for (uint32_t i = 0; i < scenario.mode_count; ++i) {
    const Status status = add_shaper(scenario.kind, kModes[i], kTickS, design);
    if (!status.ok()) return status;
  }
  return kOk;
}

// `stages` equal stages of `taps` (odd) equal gains, ten ticks apart.
inline ShaperDesign cascade_of(uint32_t stages, uint32_t taps) {
  ShaperDesign design{};
  for (uint32_t s = 0; s < stages; ++s) {
    design.stages[design.stage_count++] = Stage{design.tap_count, taps};
    const int32_t gain = kUnityGain / static_cast<int32_t>(taps);
    for (uint32_t t = 0; t < taps; ++t) {
      const int32_t rest = t == 0 ? kUnityGain - gain * static_cast<int32_t>(taps) : 0;
      design.taps[design.tap_count++] = Tap{10 * t, gain + rest};
    }
  }
  return design;
}

}  // namespace stillpoint::bench
