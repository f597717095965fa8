// SPDX-License-Identifier: Apache-2.0
// The whole chain on simulated arms, and what it refuses.
#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "tests/shaper/tune/tuning_task.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

TEST_F(Tuning, one_command_leads_from_an_unknown_arm_to_a_shaper) {
  start();
  run_to(TuneState::kKept);
  const std::vector<TuneState> expected = {TuneState::kExciting, TuneState::kCapturing, TuneState::kIdentifying,
                                           TuneState::kApplying, TuneState::kVerifying, TuneState::kKept};
  TEST_ASSERT_TRUE(rig.states == expected);
  TEST_ASSERT_TRUE(is_found(report(), 11.0, 0.03));
  TEST_ASSERT_EQUAL_UINT32(2, report().identification.mode_count);
  TEST_ASSERT_EQUAL_ENUM(TuneSource::kAccelerometer, report().source);
  TEST_ASSERT_EQUAL_ENUM(TuneExcitation::kMove, report().excited_by);
  TEST_ASSERT_EQUAL_UINT32(100, report().progress_percent);
  TEST_ASSERT_TRUE(report().source_enough);
  ShaperDesign proposed{};
  TEST_ASSERT_OK(design_of(report().proposal, kTuneTick, proposed));
  TEST_ASSERT_TRUE(same(proposed, rig.axis->shaper()));
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, proposed.length_ticks() * kTuneTick, report().proposal.length_s);
  TEST_ASSERT_AT_MOST_DOUBLE(config.tolerance, report().proposal.residual);
  TEST_ASSERT_AT_MOST_DOUBLE(0.05 * report().plain_ringing, report().shaped_ringing);
  TEST_ASSERT_EQUAL_INT64(0, rig.axis->state().setpoint);  // back where it began
}

TEST_F(Tuning, what_was_announced_is_what_moves) {
  Announcement announced{};
  TEST_ASSERT_OK(rig.tune.start(config, &announced));
  const AxisLimits peaks{announced.velocity, announced.acceleration, announced.acceleration, announced.jerk};
  StreamCheck check(rig.axis->state().setpoint, true, peaks, kTuneTick);
  Signal furthest = 0;
  uint32_t moving = 0;
  rig.on_tick = [&](Signal setpoint) {
    check.next(setpoint);
    moving += setpoint != furthest ? 1 : 0;
    furthest = std::max(furthest, setpoint);
  };
  run_until(TuneState::kIdentifying);
  TEST_ASSERT_TRUE(check.within(0));
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(kDistance), furthest);
  TEST_ASSERT_DOUBLE_WITHIN(0.0, kDistance, announced.travel);
  TEST_ASSERT_DOUBLE_WITHIN(1.5 * kTuneTick, announced.duration_s, moving * kTuneTick);
  // And not just anything: the peaks are reached.
  TEST_ASSERT_AT_LEAST_DOUBLE(-1e-3 * announced.velocity * kTuneTick * 4294967296.0, check.velocity_excess);
  TEST_ASSERT_AT_MOST_DOUBLE(paper_limits().velocity, announced.velocity);
  TEST_ASSERT_AT_MOST_DOUBLE(paper_limits().jerk, announced.jerk);
}

TEST_F(Tuning, a_proposal_waits_for_an_answer) {
  config.accept_by_itself = false;
  start();
  run_to(TuneState::kProposed);
  TEST_ASSERT_TRUE(rig.tune.busy());
  TEST_ASSERT_AT_LEAST_INT64(1, report().proposal.spec_count);
  for (int i = 0; i < 100; ++i) rig.step();
  TEST_ASSERT_EQUAL_ENUM(TuneState::kProposed, report().state);
  TEST_ASSERT_OK(rig.tune.accept());
  run_to(TuneState::kKept);
}

TEST_F(Tuning, a_proposal_that_is_dropped_leaves_the_shaper_of_before) {
  config.accept_by_itself = false;
  start();
  run_to(TuneState::kProposed);
  TEST_ASSERT_OK(rig.tune.undo());
  run_to(TuneState::kUndone);
  check_as_before();
}

TEST_F(Tuning, what_was_kept_can_be_undone_later) {
  start();
  run_to(TuneState::kKept);
  for (int i = 0; i < 1000; ++i) rig.step();
  TEST_ASSERT_OK(rig.tune.undo());
  run_to(TuneState::kUndone);
  check_as_before();
  TEST_ASSERT_REFUSED(kBusy, kNone, rig.tune.undo());
}

TEST_F(Tuning, zero_delay_is_verified_too) {
  config.move.zero_delay = true;
  start();
  run_to(TuneState::kKept);
}

TEST_F(Tuning, answers_at_the_wrong_time_are_refused) {
  TEST_ASSERT_REFUSED(kBusy, kNone, rig.tune.accept());
  TEST_ASSERT_REFUSED(kBusy, kNone, rig.tune.undo());
  start();
  TEST_ASSERT_REFUSED(kBusy, kNone, rig.tune.start(config, nullptr));
  for (int i = 0; i < 500; ++i) rig.step();
  TEST_ASSERT_REFUSED(kBusy, kNone, rig.tune.accept());
  TEST_ASSERT_REFUSED(kBusy, kNone, rig.tune.undo());
  run_to(TuneState::kKept);
}

TEST_F(Tuning, what_cannot_be_done_is_refused_by_name_and_nothing_moves) {
  const TuneConfig good = config;
  const Signal stands = rig.axis->state().setpoint;
  const auto refused = [&](auto change, Error error, Quantity quantity) {
    TuneConfig bad = good;
    change(bad);
    Announcement announced{};
    const Status status = rig.tune.start(bad, &announced);
    TEST_ASSERT_EQUAL_ENUM(error, status.error);
    TEST_ASSERT_EQUAL_ENUM(quantity, status.quantity);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, announced.duration_s);
    TEST_ASSERT_FALSE(rig.tune.busy());
    for (int i = 0; i < 5; ++i) rig.step();
    TEST_ASSERT_EQUAL_INT64(stands, rig.axis->state().setpoint);
    TEST_ASSERT_TRUE(same(old, rig.axis->shaper()));
  };
  using C = TuneConfig;
  refused([](C& c) { c.move.limits.velocity *= 1.01; }, Error::kAboveMaximum, Quantity::kVelocity);
  refused([](C& c) { c.move.limits.acceleration = 0.0; }, Error::kNotPositive, Quantity::kAcceleration);
  refused([](C& c) { c.move.limits.jerk = math::kNan; }, Error::kNotFinite, Quantity::kJerk);
  refused([](C& c) { c.move.duration_s = -1.0; }, Error::kBelowMinimum, Quantity::kDuration);
  refused([](C& c) { c.move.duration_s = 0.1; }, Error::kBelowMinimum, Quantity::kDuration);
  refused([](C& c) { c.move.kind = ProfileKind::kTable; }, Error::kNotAvailable, Quantity::kTable);
  refused([](C& c) { c.move.target_counts = 0; }, Error::kNotPositive, Quantity::kDistance);
  refused([](C& c) { c.travel_counts = 699999.0; }, Error::kAboveMaximum, Quantity::kTravel);
  refused([](C& c) { c.travel_counts = 0.0; }, Error::kNotPositive, Quantity::kTravel);
  refused([](C& c) { c.low_hz = 0.0; }, Error::kNotPositive, Quantity::kFrequency);
  refused([](C& c) { c.low_hz = math::kNan; }, Error::kNotFinite, Quantity::kFrequency);
  refused([](C& c) { c.high_hz = 1.0; }, Error::kBelowMinimum, Quantity::kFrequency);
  refused([](C& c) { c.high_hz = 401.0; }, Error::kAboveMaximum, Quantity::kFrequency);
  refused([](C& c) { c.low_hz = 0.5; }, Error::kBelowMinimum, Quantity::kFrequency);
  refused([](C& c) { c.tolerance = 0.0; }, Error::kBelowMinimum, Quantity::kTolerance);
  refused([](C& c) { c.tolerance = 0.3; }, Error::kAboveMaximum, Quantity::kTolerance);
  refused([](C& c) { c.excitation = static_cast<TuneExcitation>(9); }, Error::kAboveMaximum, Quantity::kKind);
  refused([](C& c) { c.source = static_cast<TuneSource>(3); }, Error::kAboveMaximum, Quantity::kKind);
  // The low end is accepted where the refusal says, and with a lower high end.
  config.low_hz = 3.0 / 2.048;
  start();
  rig.tune.abort();
  run_to(TuneState::kFailed);
  config.low_hz = 0.5;
  config.high_hz = 80.0;
  start();
}

TEST(soft_limits_hold_for_the_way_there_and_back) {
  const auto rig_from = [](int32_t start) {
    sim::SimulatedDriveConfig drive = drive_config(kArm, 1);
    drive.start = signal_from_counts(start);
    return TuningRig(drive, [](AxisConfig& axis) {
      axis.soft_low_counts = -1000;
      axis.soft_high_counts = 600000;
    });
  };
  TuningRig inside = rig_from(0);
  TEST_ASSERT_REFUSED(kAboveMaximum, kPosition, inside.tune.start(tune_config(kDistance), nullptr));
  TEST_ASSERT_OK(inside.tune.start(tune_config(500000), nullptr));
  // A single command may lead back in; a tuning would have to come out again.
  TuningRig outside = rig_from(-2000);
  TEST_ASSERT_REFUSED(kBelowMinimum, kPosition, outside.tune.start(tune_config(500000), nullptr));
}

TEST(a_rotary_axis_is_tuned_over_the_place_where_it_reads_zero) {
  for (const Approach approach : {Approach::kShortest, Approach::kPositive, Approach::kNegative}) {
    sim::SimulatedDriveConfig drive = drive_config(kArm, 1);
    drive.start = signal_from_counts(900000) + 12345;  // between two counts
    TuningRig rig(drive, [](AxisConfig& axis) { axis.modulo_counts = 1200000; });
    TEST_ASSERT_OK(rig.configured);
    TuneConfig config = tune_config(200000);
    config.move.approach = approach;
    Signal low = drive.start;
    Signal high = drive.start;
    rig.on_tick = [&](Signal setpoint) {
      low = std::min(low, setpoint);
      high = std::max(high, setpoint);
    };
    const int32_t begins_at = rig.axis->reading_counts();
    Announcement announced{};
    TEST_ASSERT_OK(rig.tune.start(config, &announced));
    TEST_ASSERT_TRUE(rig.run());
    TEST_INFO(approach, static_cast<int>(approach));
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, rig.tune.report().state);
    TEST_ASSERT_EQUAL_INT32(begins_at, rig.axis->reading_counts());
    const Signal swept = high - low;
    TEST_ASSERT_DOUBLE_WITHIN(1.0, announced.travel, static_cast<double>(swept) / 4294967296.0);
  }
}

TEST_F(Tuning, a_moving_axis_is_not_tuned) {
  TEST_ASSERT_OK(rig.axis->command(config.move, nullptr));
  TEST_ASSERT_REFUSED(kBusy, kNone, rig.tune.start(config, nullptr));
  rig.tick();
  TEST_ASSERT_REFUSED(kBusy, kNone, rig.tune.start(config, nullptr));
}

TEST(a_tuner_without_an_axis_has_nothing_to_tune) {
  AutoTune tune;
  TEST_ASSERT_REFUSED(kNotAvailable, kNone, tune.start(tune_config(kDistance), nullptr));
  tune.tick({});
  tune.service({});
  tune.abort();
  TEST_ASSERT_EQUAL_ENUM(TuneState::kIdle, tune.report().state);
}

TEST(an_axis_without_the_memory_is_refused) {
  Axis<100> axis;
  const auto memory = std::make_unique<TuneMemory>();
  AutoTune tune;
  const AxisLimits limits = paper_limits();
  TEST_ASSERT_OK(axis.configure({kTuneTick, limits, limits.acceleration, limits.jerk}));
  axis.reset(0);
  tune.begin(axis, *memory);
  TEST_ASSERT_REFUSED(kLineTooShort, kSamples, tune.start(tune_config(kDistance), nullptr));
}

TEST(a_tuner_is_all_zeros_to_begin_with) {
  const auto tune = std::make_unique<AutoTune>();
  std::vector<unsigned char> bytes(sizeof(AutoTune));
  std::memcpy(bytes.data(), static_cast<const void*>(tune.get()), bytes.size());
  TEST_ASSERT_TRUE(std::all_of(bytes.begin(), bytes.end(), [](unsigned char byte) { return byte == 0; }));
}
