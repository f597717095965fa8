// SPDX-License-Identifier: Apache-2.0
// Tuning by a stepped sine and by a chirp, on simulated arms. The truth is asked of the arm.
#include <algorithm>
#include <cmath>

#include "tests/shaper/tune/tuning_rig.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapers.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

TuneConfig sine_config(double low_hz, double high_hz, TuneExcitation kind = TuneExcitation::kSteppedSine) {
  TuneConfig config = tune_config(700000);
  config.excitation = kind;
  config.low_hz = low_hz;
  config.high_hz = high_hz;
  return config;
}

// The axis's limits in every tick, whichever way it goes, and how far it goes.
struct Watched {
  StreamCheck forward;
  StreamCheck backward;
  Signal furthest = 0;
  explicit Watched(const AxisLimits& limits, Signal start = 0)
      : forward(start, true, limits, kTuneTick), backward(start, false, limits, kTuneTick) {}
  void watch(TuningRig& rig) {
    rig.on_tick = [this](Signal setpoint) {
      forward.next(setpoint);
      backward.next(setpoint);
      furthest = std::max(furthest, setpoint < 0 ? -setpoint : setpoint);
    };
  }
  bool within(uint32_t stages) const { return forward.within(stages) && backward.within(stages); }
};

void check_mode(const Identification& found, const Mode& mode, double of_frequency, double of_damping) {
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, found.finding);
  TEST_ASSERT_AT_LEAST_INT64(1, static_cast<int64_t>(found.mode_count));
  TEST_ASSERT_DOUBLE_RELATIVE(of_frequency, mode.frequency_hz, found.mode[0].frequency_hz);
  TEST_ASSERT_DOUBLE_RELATIVE(of_damping, mode.damping_ratio, found.mode[0].damping_ratio);
}

}  // namespace

TEST(a_well_damped_arm_is_found_as_announced_and_stilled) {
  for (const double damping : {0.05, 0.1, 0.2, 0.3}) {
    TEST_INFO(damping, damping);
    TuningRig rig(sim::ArmModes{{{11.0, damping}, 0.9}});
    Announcement told{};
    TEST_ASSERT_OK(rig.tune.start(sine_config(5.0, 40.0), &told));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1e4, told.travel);
    Watched watched({told.velocity, told.acceleration, told.acceleration, told.jerk});
    watched.watch(rig);
    uint32_t exciting = 0;
    while (rig.tune.report().state == TuneState::kExciting) {
      rig.step();
      ++exciting;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02, told.duration_s, exciting * kTuneTick);
    TEST_ASSERT_TRUE(watched.within(0));
    TEST_ASSERT_TRUE(rig.run());
    TEST_ASSERT_TRUE(watched.within(2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, told.travel, static_cast<double>(watched.furthest) / 4294967296.0);
    const TuneReport& report = rig.tune.report();
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, report.state);
    TEST_ASSERT_EQUAL_ENUM(TuneExcitation::kSteppedSine, report.excited_by);
    check_mode(report.identification, {11.0, damping}, 1e-3, 1e-2);
    TEST_ASSERT_AT_MOST_DOUBLE(0.05 * report.plain_ringing, report.shaped_ringing);
    TEST_ASSERT_EQUAL_INT64(0, rig.axis->state().setpoint);
    TEST_ASSERT_EQUAL_UINT32(0, rig.axis->stream_state().limited_ticks);
  }
}

// Without noise: no bias but that of an arm that still rings at the end, which is 0.06 % of f at a damping of 0.01.
TEST(a_chirp_is_exact_at_any_damping) {
  for (const double damping : {0.02, 0.05, 0.1, 0.2, 0.3}) {
    TEST_INFO(damping, damping);
    sim::SimulatedDriveConfig drive = drive_config(sim::ArmModes{{{11.0, damping}, 0.9}}, 1);
    drive.accelerometer.noise = 0.0;
    drive.accelerometer.resolution = 1e-6;
    drive.accelerometer.range = 1e3;
    TuningRig rig(drive);
    TuneConfig config = sine_config(5.0, 40.0, TuneExcitation::kChirp);
    config.source = TuneSource::kAccelerometer;
    config.sensor_lowest = config.sensor_highest = 0;
    Announcement told{};
    TEST_ASSERT_OK(rig.tune.start(config, &told));
    Watched watched({told.velocity, told.acceleration, told.acceleration, told.jerk});
    watched.watch(rig);
    for (int i = 0; i < 100000 && rig.tune.report().state == TuneState::kExciting; ++i) rig.step();
    TEST_ASSERT_TRUE(watched.within(0));
    TEST_ASSERT_TRUE(rig.run());
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, rig.tune.report().state);
    TEST_ASSERT_EQUAL_ENUM(TuneExcitation::kChirp, rig.tune.report().excited_by);
    check_mode(rig.tune.report().identification, {11.0, damping}, 2e-4, 2e-3);
    TEST_ASSERT_EQUAL_UINT32(0, rig.axis->stream_state().limited_ticks);
  }
}

// Random arms, with a second mode or without, seen by the accelerometer or by what they shake their motor with.
TEST(random_arms_are_found_by_either_sensor) {
  for (uint64_t seed = 1; seed <= 16; ++seed) {
    TEST_INFO(seed, seed);
    Random random(seed);
    const bool by_error = seed % 2 == 0;
    const Mode mode{5.0 * std::pow(4.0, random.unit()), 0.02 * std::pow(15.0, random.unit())};
    sim::ArmModes arm{{mode, 0.9}};
    if (seed % 3 == 0) arm.push_back({{std::min(2.6 * mode.frequency_hz, 34.0), 0.05}, 0.1});
    sim::SimulatedDriveConfig drive = drive_config(arm, random.next());
    if (by_error) drive.reaction = 0.05;
    TuningRig rig(drive);
    TuneConfig config = sine_config(4.0, 40.0);
    config.amplitude_counts = 1000.0;  // more, and a lightly damped arm takes the accelerometer to its end
    config.source = by_error ? TuneSource::kFollowingError : TuneSource::kAuto;
    TEST_ASSERT_OK(rig.tune.start(config, nullptr));
    TEST_ASSERT_TRUE(rig.run());
    const TuneReport& report = rig.tune.report();
    TEST_INFO(damping, mode.damping_ratio);
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, report.state);
    TEST_ASSERT_EQUAL_ENUM(by_error ? TuneSource::kFollowingError : TuneSource::kAccelerometer, report.source);
    check_mode(report.identification, mode, 2e-3, 3e-2);
  }
}

// A short move, and a bump that a well damped arm answers with less than the encoder's noise.
TEST(what_neither_move_nor_bump_tell_the_sine_does) {
  sim::SimulatedDriveConfig drive = drive_config(sim::ArmModes{{{11.0, 0.3}, 0.9}}, 3);
  drive.reaction = 0.002;
  TuningRig rig(drive);
  TuneConfig config = sine_config(4.0, 40.0, TuneExcitation::kAuto);
  config.move.target_counts = 3000;
  config.amplitude_counts = 1000.0;
  config.source = TuneSource::kFollowingError;
  config.tolerance = 0.05;
  config.accept_by_itself = false;
  Announcement told{};
  TEST_ASSERT_OK(rig.tune.start(config, &told));
  TEST_ASSERT_TRUE(rig.run());
  const TuneReport& report = rig.tune.report();
  TEST_ASSERT_EQUAL_ENUM(TuneState::kProposed, report.state);
  TEST_ASSERT_EQUAL_ENUM(TuneExcitation::kSteppedSine, report.excited_by);
  TEST_ASSERT_AT_LEAST_DOUBLE(10.0 * told.duration_s, report.announced.duration_s);
  check_mode(report.identification, {11.0, 0.3}, 2e-2, 5e-2);
}

TEST(an_abort_at_any_time_comes_to_rest_with_the_shaper_of_before) {
  Random random(2);
  for (int i = 0; i < 24; ++i) {
    TEST_INFO(run, i);
    TuningRig rig(sim::ArmModes{{{11.0, 0.1}, 0.9}});
    const ShaperDesign old = shaper_of(ShaperKind::kZvd, 17.0, 0.1, kTuneTick);
    TEST_ASSERT_OK(rig.axis->set_shaper(old));
    for (int k = 0; k < 4; ++k) rig.step();
    Watched watched(paper_limits());
    watched.watch(rig);
    const bool chirps = i % 3 == 0;
    const auto kind = chirps ? TuneExcitation::kChirp : TuneExcitation::kSteppedSine;
    TEST_ASSERT_OK(rig.tune.start(sine_config(8.0, 40.0, kind), nullptr));
    const auto at = random.integer(0, chirps ? 4000 : 28000);
    for (int64_t k = 0; k < at; ++k) rig.step();
    if (!rig.tune.busy()) continue;
    rig.tune.abort();
    TEST_ASSERT_TRUE(rig.run());
    TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, rig.tune.report().state);
    TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, rig.tune.report().identification.finding);
    TEST_ASSERT_EQUAL_ENUM(AxisPhase::kAtRest, rig.axis->state().phase);
    TEST_ASSERT_TRUE(watched.within(4));
    TEST_ASSERT_EQUAL_UINT32(old.length_ticks(), rig.axis->shaper().length_ticks());
    TEST_ASSERT_EQUAL_UINT32(old.tap_count, rig.axis->shaper().tap_count);
  }
}

// No arm, a sensor at its end, and one that misses ticks.
TEST(what_does_not_tell_is_not_found) {
  for (int i = 0; i < 6; ++i) {
    const int what = i / 2;
    TEST_INFO(what, what);
    TuningRig rig(what == 0 ? sim::ArmModes{} : sim::ArmModes{{{11.0, 0.1}, 0.9}});
    TuneConfig config = sine_config(8.0, 40.0, i % 2 == 0 ? TuneExcitation::kSteppedSine : TuneExcitation::kChirp);
    if (what == 1) config.sensor_highest = 20;
    uint32_t ticks = 0;
    if (what == 2) rig.on_sample = [&ticks](TuneSample& sample) { sample.fresh = ++ticks % 33 != 0; };
    TEST_ASSERT_OK(rig.tune.start(config, nullptr));
    TEST_ASSERT_TRUE(rig.run());
    const TuneReport& report = rig.tune.report();
    constexpr Finding kFindings[] = {Finding::kNoMode, Finding::kSaturated, Finding::kNoisy};
    TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, report.state);
    TEST_ASSERT_EQUAL_ENUM(kFindings[what], report.identification.finding);
    TEST_ASSERT_EQUAL_UINT32(0, rig.axis->shaper().stage_count);
  }
}

TEST(what_has_no_room_either_way_is_refused) {
  sim::SimulatedDriveConfig drive = drive_config(sim::ArmModes{{{11.0, 0.1}, 0.9}}, 1);
  TuningRig rig(drive, [](AxisConfig& axis) {
    axis.soft_low_counts = -900;
    axis.soft_high_counts = 600000;
  });
  TuneConfig config = sine_config(8.0, 40.0);
  TEST_ASSERT_REFUSED(kAboveMaximum, kAmplitude, rig.tune.start(config, nullptr));
  config.amplitude_counts = 800.0;
  TEST_ASSERT_OK(rig.tune.start(config, nullptr));
  rig.tune.abort();
  TEST_ASSERT_TRUE(rig.run());
  config.high_hz = 390.0;  // less than a count is left
  TEST_ASSERT_REFUSED(kBelowMinimum, kJerk, rig.tune.start(config, nullptr));
}
