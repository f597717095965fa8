// SPDX-License-Identifier: Apache-2.0
// The whole chain on simulated arms, what it refuses, and how it ends when it is not let.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/shaper/tune/tuning_rig.hpp"
#include "tests/support/shapers.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

const sim::ArmModes kArm = {{{11.0, 0.03}, 0.9}, {{27.0, 0.02}, 0.1}};
constexpr int32_t kDistance = 700000;

bool same(const ShaperDesign& a, const ShaperDesign& b) {
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

bool is_found(const TuneReport& report, double frequency_hz, double damping) {
  return report.identification.finding == Finding::kFound && report.identification.mode_count > 0 &&
         std::fabs(report.identification.mode[0].frequency_hz - frequency_hz) < 0.005 * frequency_hz &&
         std::fabs(report.identification.mode[0].damping_ratio - damping) < 0.1 * damping;
}

}  // namespace

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

TEST(an_abort_at_any_time_leads_back_to_the_shaper_of_before_within_limits) {
  int seen[10] = {};
  for (int at = 0; at < 6000; at += 37) {
    Tuning tuning;
    TuningRig& rig = tuning.rig;
    TEST_INFO(at, at);
    BothWays check(rig.axis->state().setpoint);
    rig.on_tick = [&](Signal setpoint) { check.next(setpoint); };
    tuning.config.accept_by_itself = at % 2 == 0;
    tuning.start();
    for (int i = 0; i < at; ++i) rig.step();
    ++seen[static_cast<int>(tuning.report().state)];
    if (!rig.tune.busy()) continue;
    rig.tune.abort();
    tuning.run_to(TuneState::kFailed);
    TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, tuning.report().identification.finding);
    tuning.check_as_before();
    TEST_ASSERT_TRUE(check.within(4));
    // And nothing is left behind: it can be tuned again.
    const int32_t here = counts_from_signal(rig.axis->state().setpoint);
    tuning.config.move.target_counts = here > 300000 ? here - 500000 : here + 500000;
    TEST_ASSERT_OK(rig.tune.start(tuning.config, nullptr));
  }
  for (const TuneState state :
       {TuneState::kExciting, TuneState::kCapturing, TuneState::kProposed, TuneState::kVerifying})
    TEST_ASSERT_AT_LEAST_INT64(1, seen[static_cast<int>(state)]);
}

// Those that are over in a tick, and one whose ringing has yet to fade.
TEST(an_abort_between_two_steps_is_heard) {
  for (const bool fades_slowly : {false, true}) {
    for (const TuneState state : {TuneState::kIdentifying, TuneState::kApplying}) {
      for (int later = 0; later < 3; ++later) {
        Tuning tuning;
        if (fades_slowly) tuning.rig.drive = sim::SimulatedDrive(drive_config({{{3.0, 0.01}, 0.9}}, 7));
        tuning.start();
        tuning.run_until(state);
        for (int i = 0; i < later; ++i) tuning.rig.step();
        tuning.rig.tune.abort();
        tuning.run_to(TuneState::kFailed);
        TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, tuning.report().identification.finding);
        tuning.check_as_before();
      }
    }
  }
}

TEST(a_ringing_that_fades_slowly_is_waited_for) {
  TuningRig rig(sim::ArmModes{{{2.5, 0.008}, 0.9}});
  TEST_ASSERT_OK(rig.tune.start(tune_config(kDistance), nullptr));
  uint32_t waited = 0;
  for (int i = 0; i < 100000 && rig.tune.busy(); ++i) {
    rig.step();
    waited += rig.tune.report().state == TuneState::kApplying ? 1U : 0U;
  }
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, rig.tune.report().state);
  // To a tenth, less what was recorded.
  TEST_ASSERT_DOUBLE_WITHIN(0.3, 2.303 / (2.0 * M_PI * 2.5 * 0.008) - 2.05, waited * kTuneTick);
}

TEST_F(Tuning, an_abort_while_it_thinks_is_heard) {
  struct Call {
    AutoTune* tune;
    int count;
  } call{&rig.tune, 0};
  const Meanwhile meanwhile{[](void* context) {
                              Call& to = *static_cast<Call*>(context);
                              if (++to.count == 5) to.tune->abort();
                            },
                            &call};
  start();
  for (int i = 0; i < 100000 && rig.tune.busy(); ++i) {
    rig.tick();
    rig.tune.service(meanwhile);
  }
  TEST_ASSERT_AT_LEAST_INT64(5, call.count);
  TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, report().state);
  TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, report().identification.finding);
  check_as_before();
}

TEST(a_stop_or_a_reset_from_elsewhere_aborts) {
  for (int what = 0; what < 2; ++what) {
    for (int at = 5; at < 4000; at += 331) {
      TEST_INFO(what, what);
      TEST_INFO(at, at);
      Tuning tuning;
      tuning.start();
      for (int i = 0; i < at; ++i) tuning.rig.step();
      const AxisPhase phase = tuning.rig.axis->state().phase;
      const bool moves = phase == AxisPhase::kMoving || phase == AxisPhase::kDraining;
      const TuneState state = tuning.report().state;
      if (!tuning.rig.tune.busy() || (what == 0 && !moves)) continue;
      if (what == 0) tuning.rig.axis->request_stop();
      if (what == 1) tuning.rig.axis->reset(signal_from_counts(123456));
      TEST_ASSERT_TRUE(tuning.rig.run());
      // A reset while nothing moves and nothing is listened to does no harm.
      if (what == 1 && state == TuneState::kApplying) continue;
      TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, tuning.report().state);
      TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, tuning.report().identification.finding);
      tuning.check_as_before();
    }
  }
}

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

TEST(a_tuner_is_all_zeros_to_begin_with) {
  const auto tune = std::make_unique<AutoTune>();
  std::vector<unsigned char> bytes(sizeof(AutoTune));
  std::memcpy(bytes.data(), static_cast<const void*>(tune.get()), bytes.size());
  TEST_ASSERT_TRUE(std::all_of(bytes.begin(), bytes.end(), [](unsigned char byte) { return byte == 0; }));
}

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
