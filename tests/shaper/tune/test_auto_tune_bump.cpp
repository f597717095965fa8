// SPDX-License-Identifier: Apache-2.0
// Tuning by a bump, alone or after a move that does not tell.
#include <algorithm>

#include "tests/shaper/tune/tuning_task.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

// A band that lets the bump be strong.
struct Bump : Tuning {
  Bump() {
    config.excitation = TuneExcitation::kBump;
    config.low_hz = 3.0;
    config.high_hz = 40.0;
  }
};

}  // namespace

TEST_F(Bump, a_bump_finds_the_arm_within_its_limits_and_as_announced) {
  Announcement announced{};
  TEST_ASSERT_OK(rig.tune.start(config, &announced));
  BothWays check(0);
  Signal furthest = 0;
  rig.on_tick = [&](Signal setpoint) {
    check.next(setpoint);
    furthest = std::max(furthest, setpoint < 0 ? -setpoint : setpoint);
  };
  run_to(TuneState::kKept);
  TEST_ASSERT_TRUE(check.within(2));
  TEST_ASSERT_TRUE(is_found(report(), 11.0, 0.03));
  TEST_ASSERT_EQUAL_ENUM(TuneExcitation::kBump, report().excited_by);
  const double reached = static_cast<double>(furthest) / static_cast<double>(kSignalPerCount);
  TEST_ASSERT_DOUBLE_WITHIN(1e-6, announced.travel, reached);
  TEST_ASSERT_AT_LEAST_DOUBLE(1.0, reached);
  TEST_ASSERT_EQUAL_INT64(0, rig.axis->state().setpoint);
  TEST_ASSERT_EQUAL_UINT32(0, rig.axis->stream_state().limited_ticks);
}

TEST_F(Bump, an_abort_in_it_comes_to_rest_within_the_limits) {
  for (uint32_t at = 5; at < 75; at += 7) {
    start();
    BothWays check(rig.axis->state().setpoint);
    rig.on_tick = [&](Signal setpoint) { check.next(setpoint); };
    for (uint32_t i = 0; i < at; ++i) rig.step();
    rig.tune.abort();
    run_to(TuneState::kFailed);
    TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, report().identification.finding);
    TEST_ASSERT_TRUE(check.within(2));
    check_as_before();
  }
}

TEST_F(Bump, what_has_no_room_is_refused) {
  config.travel_counts = 9999.0;
  TEST_ASSERT_REFUSED(kAboveMaximum, kTravel, rig.tune.start(config, nullptr));
  config.travel_counts = 1e6;
  config.amplitude_counts = 0.0;
  TEST_ASSERT_REFUSED(kNotPositive, kAmplitude, rig.tune.start(config, nullptr));
  config.amplitude_counts = 1e4;
}

namespace {

// One mode, and a band for the bump.
struct OneMode {
  TuningRig rig;
  TuneConfig config = tune_config(kDistance);

  OneMode(double frequency_hz, double damping) : rig(sim::ArmModes{{{frequency_hz, damping}, 1.0}}) {
    TEST_ASSERT_OK(rig.configured);
    config.low_hz = 3.0;
    config.high_hz = 40.0;
  }
  const TuneReport& tune() {
    TEST_ASSERT_OK(rig.tune.start(config, nullptr));
    TEST_ASSERT_TRUE(rig.run());
    return rig.tune.report();
  }
};

}  // namespace

// A ramp of one period of the arm's, the time that velocity over acceleration comes to: it is left still by chance.
TEST(an_arm_that_the_move_leaves_still_is_found_by_the_bump) {
  const auto set_up = [](OneMode& arm, TuneExcitation excitation) {
    arm.config.excitation = excitation;
    AxisLimits& limits = arm.config.move.limits;
    limits.velocity = 8e5;
    limits.acceleration = limits.deceleration = 8e6;
    limits.jerk = 4e8;
    arm.config.move.target_counts = 560000;
  };
  OneMode by_move(10.0, 1e-3);
  set_up(by_move, TuneExcitation::kMove);
  const TuneReport& still = by_move.tune();
  TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, still.state);

  OneMode by_itself(10.0, 1e-3);
  set_up(by_itself, TuneExcitation::kAuto);
  const TuneReport& report = by_itself.tune();
  TEST_ASSERT_EQUAL_ENUM(TuneExcitation::kBump, report.excited_by);
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, report.state);
  TEST_ASSERT_TRUE(is_found(report, 10.0, 1e-3));
}

TEST(a_well_damped_arm_is_found_by_the_bump) {
  for (const double damping : {0.15, 0.2, 0.3}) {
    OneMode arm(11.0, damping);
    arm.config.excitation = TuneExcitation::kBump;
    const TuneReport& report = arm.tune();
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, report.state);
    TEST_ASSERT_AT_MOST_DOUBLE(0.05 * report.plain_ringing, report.shaped_ringing);
    // At 0.3 little more than a period rises above the noise: 0.504 % measured.
    if (damping < 0.3) TEST_ASSERT_TRUE(is_found(report, 11.0, damping));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 11.0, 11.0, report.identification.mode[0].frequency_hz);
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * damping, damping, report.identification.mode[0].damping_ratio);
  }
}
