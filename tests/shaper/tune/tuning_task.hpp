// SPDX-License-Identifier: Apache-2.0
// An arm of two modes behind an axis that has a shaper already, and what a tuning of it is asked for.
#pragma once

#include <cmath>

#include "tests/shaper/tune/tuning_rig.hpp"
#include "tests/support/shapers.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

inline const sim::ArmModes kArm = {{{11.0, 0.03}, 0.9}, {{27.0, 0.02}, 0.1}};
constexpr int32_t kDistance = 700000;

inline bool same(const ShaperDesign& a, const ShaperDesign& b) {
  if (a.stage_count != b.stage_count || a.tap_count != b.tap_count) return false;
  for (uint32_t i = 0; i < a.tap_count; ++i) {
    if (a.taps[i].delay_ticks != b.taps[i].delay_ticks || a.taps[i].gain != b.taps[i].gain) return false;
  }
  return true;
}

// The axis's limits, whichever way it goes.
struct BothWays {
  StreamCheck forward;
  StreamCheck backward;
  explicit BothWays(Signal start)
      : forward(start, true, paper_limits(), kTuneTick), backward(start, false, paper_limits(), kTuneTick) {}
  void next(Signal setpoint) {
    forward.next(setpoint);
    backward.next(setpoint);
  }
  bool within(uint32_t stages) const { return forward.within(stages) && backward.within(stages); }
};

struct Tuning {
  TuningRig rig{kArm};
  TuneConfig config = tune_config(kDistance);
  ShaperDesign old = shaper_of(ShaperKind::kZvd, 17.0, 0.1, kTuneTick);

  Tuning() {
    TEST_ASSERT_OK(rig.configured);
    TEST_ASSERT_OK(rig.axis->set_shaper(old));
    for (int i = 0; i < 4; ++i) rig.step();
    rig.states.clear();
  }

  const TuneReport& report() const { return rig.tune.report(); }
  void start() { TEST_ASSERT_OK(rig.tune.start(config, nullptr)); }
  void run_to(TuneState state) {
    TEST_ASSERT_TRUE(rig.run());
    TEST_ASSERT_EQUAL_ENUM(state, report().state);
  }
  void run_until(TuneState state) {
    for (int i = 0; i < 100000 && report().state != state; ++i) rig.step();
    TEST_ASSERT_EQUAL_ENUM(state, report().state);
  }
  void check_as_before() {
    TEST_ASSERT_EQUAL_ENUM(AxisPhase::kAtRest, rig.axis->state().phase);
    TEST_ASSERT_FALSE(rig.axis->pending());
    TEST_ASSERT_TRUE(same(old, rig.axis->shaper()));
  }
};

inline bool is_found(const TuneReport& report, double frequency_hz, double damping) {
  return report.identification.finding == Finding::kFound && report.identification.mode_count > 0 &&
         std::fabs(report.identification.mode[0].frequency_hz - frequency_hz) < 0.005 * frequency_hz &&
         std::fabs(report.identification.mode[0].damping_ratio - damping) < 0.1 * damping;
}

}  // namespace stillpoint::testing
