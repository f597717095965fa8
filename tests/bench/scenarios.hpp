// SPDX-License-Identifier: Apache-2.0
// What is measured, the same on the host and on the chip: the reference move (Li 2017's arm; 1,000,000 counts a unit)
// behind every shaper, and shapers of hand-made stages.
#pragma once

#include "shaper/axis/axis.hpp"
#include "shaper/profile/plan_from.hpp"
#include "shaper/shaping/design.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::bench {

constexpr double kTickS = 0.001;
constexpr AxisLimits kLimits{1.2e6, 20e6, 20e6, 600e6};
constexpr AxisConfig kAxis{kTickS, kLimits, 100e6, 100e9};
constexpr Move kMove{1700000, ProfileKind::kSCurve, kLimits, 0.0, false};
constexpr Move kMoveBack{0, ProfileKind::kSCurve, kLimits, 0.0, false};
constexpr size_t kCapacity = 1024;

// A move to plan: limits around those of the reference move, up and down apart, and a state of motion within them.
struct PlanTask {
  AxisLimits limits;
  StartMotion start;
  double distance;
};

inline PlanTask random_plan_task(testing::Random& random) {
  const auto around = [&](double value) { return value * random.between(0.3, 3.0); };
  PlanTask task{};
  task.limits = AxisLimits{around(kLimits.velocity), around(kLimits.acceleration), around(kLimits.deceleration),
                           around(kLimits.jerk), around(kLimits.jerk)};
  task.start.velocity = 0.5 * task.limits.velocity * random.between(-1.0, 1.0);
  task.start.acceleration = 0.3 * task.limits.acceleration * random.between(-1.0, 1.0);
  // From a thousandth of the reference move to all of it: with a cruise and without.
  const double part = random.between(0.001, 1.0);
  const auto counts = static_cast<int32_t>(kMove.target_counts * part * part * part) + 1;
  task.distance = random.next() % 2 == 0 ? counts : -counts;
  return task;
}

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
