// SPDX-License-Identifier: Apache-2.0
// What its records may be like, and what it makes of them.
#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/shaper/tune/tuning_task.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

TEST_F(Tuning, a_shaper_that_does_not_help_is_undone) {
  config.accept_by_itself = false;
  start();
  run_to(TuneState::kProposed);
  // Another arm.
  sim::SimulatedDriveConfig other = drive_config({{{6.0, 0.01}, 0.9}, {{15.0, 0.02}, 0.1}}, 5);
  other.start = rig.drive.motor();
  rig.drive = sim::SimulatedDrive(other);
  TEST_ASSERT_OK(rig.tune.accept());
  run_to(TuneState::kUndone);
  TEST_ASSERT_AT_LEAST_DOUBLE(0.5 * report().plain_ringing, report().shaped_ringing);
  check_as_before();
}

TEST_F(Tuning, an_accelerometer_at_its_end_is_saturated) {
  rig.on_sample = [](TuneSample& sample) { sample.acceleration = std::max(-700, std::min(700, sample.acceleration)); };
  // Told by the sensor's range, and by the record itself.
  for (const int32_t range : {700, 0}) {
    TEST_INFO(range, range);
    config.sensor_lowest = -range;
    config.sensor_highest = range;
    start();
    run_to(TuneState::kFailed);
    TEST_ASSERT_EQUAL_ENUM(Finding::kSaturated, report().identification.finding);
    check_as_before();
    config.move.target_counts = counts_from_signal(rig.axis->state().setpoint) == 0 ? kDistance : 0;
  }
}

TEST_F(Tuning, a_record_with_gaps_is_taken_again_once) {
  // 30 ms a second: in the first record only, then in all.
  uint32_t ticks = 0;
  uint32_t until = 3000;
  rig.on_sample = [&](TuneSample& sample) {
    sample.fresh = ++ticks > until || ticks % 33 != 0;
    if (!sample.fresh) sample.acceleration = sample.acceleration / 2 + 5000;
  };
  start();
  run_to(TuneState::kKept);
  TEST_ASSERT_EQUAL_UINT32(0, report().flaws.gaps);
  TEST_ASSERT_TRUE(is_found(report(), 11.0, 0.03));
  TEST_ASSERT_OK(rig.tune.undo());
  run_to(TuneState::kUndone);
  until = UINT32_MAX;
  config.move.target_counts = counts_from_signal(rig.axis->state().setpoint) == 0 ? kDistance : 0;
  start();
  run_to(TuneState::kFailed);
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoisy, report().identification.finding);
  TEST_ASSERT_AT_LEAST_INT64(20, report().flaws.gaps);
  check_as_before();
}

TEST_F(Tuning, few_gaps_do_not_matter) {
  uint32_t ticks = 0;
  rig.on_sample = [&](TuneSample& sample) { sample.fresh = ++ticks % 200 != 0; };
  start();
  run_to(TuneState::kKept);
  TEST_ASSERT_AT_LEAST_INT64(5, report().flaws.gaps);
  TEST_ASSERT_TRUE(is_found(report(), 11.0, 0.03));
}

TEST(no_sensor_finds_no_mode) {
  // A stiff motor, and an accelerometer that is not there; noise on the encoder, or none.
  for (const double noise : {0.0, 1.0}) {
    for (const TuneSource source : {TuneSource::kAuto, TuneSource::kAccelerometer, TuneSource::kFollowingError}) {
      sim::SimulatedDriveConfig drive = drive_config(kArm, 3);
      drive.encoder.noise_counts = noise;
      TuningRig rig(drive);
      rig.on_sample = [](TuneSample& sample) { sample.acceleration = 0; };
      TuneConfig config = tune_config(kDistance);
      config.source = source;
      for (int i = 0; i < 4; ++i) rig.tick();
      // The first samples were still the drive's.
      AutoTune& tune = rig.tune;
      TEST_ASSERT_OK(tune.start(config, nullptr));
      TEST_ASSERT_TRUE(rig.run());
      TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, tune.report().state);
      const Finding finding = tune.report().identification.finding;
      TEST_ASSERT_TRUE(finding == Finding::kNoMode || finding == Finding::kNoisy);
      TEST_ASSERT_EQUAL_UINT32(0, rig.axis->shaper().stage_count);
    }
  }
}

TEST(an_accelerometer_that_reads_nothing_at_rest_is_heard_once_it_moves) {
  sim::SimulatedDriveConfig drive = drive_config(kArm, 3);
  drive.accelerometer.noise = 0.0;
  TuningRig rig(drive);
  TEST_ASSERT_OK(rig.tune.start(tune_config(kDistance), nullptr));
  TEST_ASSERT_EQUAL_ENUM(TuneSource::kAuto, rig.tune.report().source);
  TEST_ASSERT_TRUE(rig.run());
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, rig.tune.report().state);
  TEST_ASSERT_EQUAL_ENUM(TuneSource::kAccelerometer, rig.tune.report().source);
}

TEST(a_hum_is_no_mode_and_does_not_hide_one) {
  for (const bool has_arm : {false, true}) {
    TuningRig rig(has_arm ? kArm : sim::ArmModes{});
    uint32_t ticks = 0;
    rig.on_sample = [&](TuneSample& sample) {
      sample.acceleration += static_cast<int32_t>(300.0 * std::sin(2.0 * M_PI * 50.0 * kTuneTick * ++ticks));
    };
    TEST_ASSERT_OK(rig.tune.start(tune_config(kDistance), nullptr));
    TEST_ASSERT_TRUE(rig.run());
    TEST_INFO(has_arm, has_arm);
    TEST_ASSERT_EQUAL_ENUM(has_arm ? TuneState::kKept : TuneState::kFailed, rig.tune.report().state);
    if (has_arm) TEST_ASSERT_TRUE(is_found(rig.tune.report(), 11.0, 0.03));
  }
}

TEST(noise_is_no_mode) {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    TEST_INFO(seed, seed);
    TuningRig rig(sim::ArmModes{}, seed);
    TEST_ASSERT_OK(rig.tune.start(tune_config(kDistance), nullptr));
    TEST_ASSERT_TRUE(rig.run());
    TEST_ASSERT_TRUE(rig.tune.report().state != TuneState::kKept);
  }
}

TEST(modes_outside_the_band_are_nobodys) {
  TuningRig rig(kArm);
  TuneConfig config = tune_config(kDistance);
  config.low_hz = 50.0;
  TEST_ASSERT_OK(rig.tune.start(config, nullptr));
  TEST_ASSERT_TRUE(rig.run());
  TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, rig.tune.report().state);
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoMode, rig.tune.report().identification.finding);
}

TEST(an_arm_that_shakes_its_motor_is_found_from_the_following_error) {
  TuningRig rig(kArm);
  // A fiftieth of the tip's swing comes back to the motor; no accelerometer has ever spoken.
  auto tune = std::make_unique<AutoTune>();
  tune->begin(*rig.axis, *rig.memory);
  rig.on_sample = [&](TuneSample& sample) {
    const double swing = (rig.drive.tip_position() - rig.drive.motor_position()) * kTuneCounts;
    sample.position += static_cast<Signal>(0.02 * swing) * kSignalPerCount;
    sample.acceleration = 0;
    tune->tick(sample);
  };
  TuneConfig config = tune_config(kDistance);
  config.tolerance = 0.05;
  rig.tick();
  TEST_ASSERT_OK(tune->start(config, nullptr));
  for (int i = 0; i < 100000 && tune->busy(); ++i) {
    rig.tick();
    rig.axis->service();
    tune->service({});
  }
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, tune->report().state);
  TEST_ASSERT_EQUAL_ENUM(TuneSource::kFollowingError, tune->report().source);
  TEST_ASSERT_TRUE(is_found(tune->report(), 11.0, 0.03));
  TEST_ASSERT_TRUE(tune->report().source_enough);
}
