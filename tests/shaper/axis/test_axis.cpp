// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/axis.hpp"

#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;
using stillpoint::testing::StreamCheck;

namespace {

constexpr double kTick = 1e-3;
const AxisLimits kMaximum{2e6, 40e6, 40e6, 2e9};
const AxisLimits kMoveLimits{1.2e6, 20e6, 20e6, 600e6};

struct StandingAxis {
  Axis<512> axis = {};

  StandingAxis() { TEST_ASSERT_OK(axis.configure(AxisConfig{kTick, kMaximum, 40e6, 2e9})); }

  Status command(int32_t target_counts, double duration_s = 0.0, bool zero_delay = false,
                 MoveReport* report = nullptr) {
    return axis.command(Move{target_counts, ProfileKind::kSCurve, kMoveLimits, duration_s, zero_delay}, report);
  }

  void shape(ShaperKind kind, double frequency_hz = 11.0, double damping_ratio = 0.11) {
    ShaperDesign design{};
    TEST_ASSERT_OK(add_shaper(kind, Mode{frequency_hz, damping_ratio}, kTick, design));
    TEST_ASSERT_OK(axis.set_shaper(design));
    axis.tick();
  }

  uint32_t ticks_until_rest(uint32_t give_up = 100000) {
    uint32_t ticks = 0;
    do {
      axis.tick();
      ++ticks;
    } while (axis.state().phase != AxisPhase::kAtRest && ticks < give_up);
    return ticks;
  }
};

}  // namespace

TEST(an_axis_that_was_never_configured_refuses_commands_and_stands) {
  Axis<16> axis = {};
  TEST_ASSERT_REFUSED(kNotAvailable, kNone,
                      axis.command(Move{1, ProfileKind::kSCurve, kMoveLimits, 0, false}, nullptr));
  TEST_ASSERT_EQUAL_INT64(0, axis.tick());
}

TEST_F(StandingAxis, a_move_arrives_on_its_target_to_the_last_bit_and_says_when) {
  MoveReport report{};
  TEST_ASSERT_OK(command(1700000, 0.0, false, &report));
  TEST_ASSERT_EQUAL_UINT32(1510, report.profile_ticks);
  TEST_ASSERT_EQUAL_UINT32(1510, report.total_ticks);
  TEST_ASSERT_EQUAL_UINT32(1510, ticks_until_rest());
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), axis.state().setpoint);
}

TEST_F(StandingAxis, a_shaped_move_takes_the_length_of_the_shaper_more) {
  shape(ShaperKind::kZv);
  MoveReport report{};
  TEST_ASSERT_OK(command(1700000, 1.62, false, &report));
  TEST_ASSERT_EQUAL_UINT32(1620, report.profile_ticks);
  TEST_ASSERT_EQUAL_UINT32(1666, report.total_ticks);
  TEST_ASSERT_FALSE(report.zero_delay_met);
  TEST_ASSERT_EQUAL_UINT32(1666, ticks_until_rest());
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), axis.state().setpoint);
}

TEST_F(StandingAxis, what_needs_rest_is_refused_while_moving_or_waiting_and_changes_nothing) {
  TEST_ASSERT_OK(command(1000));
  TEST_ASSERT_REFUSED(kBusy, kNone, command(2000));
  axis.tick();
  TEST_ASSERT_REFUSED(kBusy, kNone, command(2000, 1.0));
  TEST_ASSERT_REFUSED(kBusy, kNone, command(2000, 0.0, true));
  TEST_ASSERT_REFUSED(kBusy, kNone, axis.set_shaper(ShaperDesign{}));
  TEST_ASSERT_REFUSED(kBusy, kNone, axis.configure(AxisConfig{kTick, kMaximum, 40e6, 2e9}));
  ticks_until_rest();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1000), axis.state().setpoint);
}

TEST_F(StandingAxis, nothing_pending_takes_effect_without_a_commit) {
  TEST_ASSERT_OK(command(1000));
  for (int i = 0; i < 50; ++i) TEST_ASSERT_EQUAL_INT64(0, axis.tick(false));
  TEST_ASSERT_TRUE(axis.pending());
  axis.tick(true);
  TEST_ASSERT_FALSE(axis.pending());
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kMoving);
}

TEST_F(StandingAxis, bad_moves_are_refused_by_name_and_the_axis_stands) {
  const double nan = __builtin_nan("");
  const auto with = [this](const AxisLimits& limits) {
    return axis.command(Move{1000, ProfileKind::kSCurve, limits, 0, false}, nullptr);
  };
  TEST_ASSERT_REFUSED(kNotFinite, kVelocity, with({nan, 1, 1, 1}));
  TEST_ASSERT_REFUSED(kNotPositive, kAcceleration, with({1, 0, 1, 1}));
  TEST_ASSERT_REFUSED(kNotPositive, kDeceleration, with({1, 1, -1, 1}));
  TEST_ASSERT_REFUSED(kNotFinite, kJerk, with({1, 1, 1, __builtin_inf()}));
  const Status fast = with({2.1e6, 1, 1, 1});
  TEST_ASSERT_REFUSED(kAboveMaximum, kVelocity, fast);
  TEST_ASSERT_DOUBLE_WITHIN(0, 2e6, fast.accepted);
  TEST_ASSERT_REFUSED(kNotFinite, kDuration, command(1000, nan));
  TEST_ASSERT_REFUSED(kBelowMinimum, kDuration, command(1000, -1.0));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDuration, command(1000, 1e12));
  const Status short_time = command(1700000, 1.5);
  TEST_ASSERT_REFUSED(kBelowMinimum, kDuration, short_time);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 1.510, short_time.accepted);
  axis.reset(signal_from_counts(-10));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDistance, command(INT32_MAX));
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(-10), axis.tick());
  TEST_ASSERT_FALSE(axis.pending());
}

TEST_F(StandingAxis, a_bad_configuration_is_refused_and_the_old_one_stays) {
  TEST_ASSERT_REFUSED(kNotPositive, kVelocity, axis.configure(AxisConfig{kTick, {0, 1, 1, 1}, 1, 1}));
  TEST_ASSERT_REFUSED(kNotPositive, kTick, axis.configure(AxisConfig{0, kMaximum, 1, 1}));
  TEST_ASSERT_REFUSED(kNotFinite, kJerk, axis.configure(AxisConfig{kTick, kMaximum, 1e6, __builtin_nan("")}));
  TEST_ASSERT_DOUBLE_WITHIN(0, kTick, axis.config().tick_s);
  TEST_ASSERT_OK(command(1000));
}

TEST_F(StandingAxis, another_tick_is_refused_while_a_shaper_is_designed_for_this_one) {
  shape(ShaperKind::kZv);
  TEST_ASSERT_REFUSED(kNotAvailable, kTick, axis.configure(AxisConfig{2e-3, kMaximum, 40e6, 2e9}));
  TEST_ASSERT_OK(axis.set_shaper(ShaperDesign{}));
  axis.tick();
  TEST_ASSERT_OK(axis.configure(AxisConfig{2e-3, kMaximum, 40e6, 2e9}));
}

TEST_F(StandingAxis, what_needs_the_spare_memory_waits_while_it_is_lent) {
  shape(ShaperKind::kZv);
  size_t doubles = 0;
  double* const lent = axis.lend_memory(doubles);
  TEST_ASSERT_TRUE(lent != nullptr);
  TEST_ASSERT_EQUAL_UINT64(512, doubles);
  for (size_t i = 0; i < doubles; ++i) lent[i] = 1e300;
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{37.3, 0.05}, kTick, design));
  TEST_ASSERT_REFUSED(kBusy, kNone, axis.set_shaper(design));
  TEST_ASSERT_REFUSED(kBusy, kNone, command(1700000, 0.0, true));
  TEST_ASSERT_OK(command(1700000));
  ticks_until_rest();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), axis.state().setpoint);
  axis.take_memory_back();
  TEST_ASSERT_OK(axis.set_shaper(design));
  TEST_ASSERT_TRUE(axis.lend_memory(doubles) == nullptr);
  axis.tick();
  TEST_ASSERT_OK(command(0, 0.0, true));
  ticks_until_rest();
  TEST_ASSERT_EQUAL_INT64(0, axis.state().setpoint);
}

TEST_F(StandingAxis, a_shaper_too_long_for_the_line_is_refused_and_the_old_one_stays) {
  shape(ShaperKind::kZv);
  ShaperDesign longer{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{0.5, 0.0}, kTick, longer));
  const Status status = axis.set_shaper(longer);
  TEST_ASSERT_REFUSED(kLineTooShort, kDelay, status);
  TEST_ASSERT_DOUBLE_WITHIN(0, 512, status.accepted);
  TEST_ASSERT_EQUAL_UINT32(46, axis.shaper().length_ticks());
}

TEST_F(StandingAxis, reset_puts_it_anywhere_without_a_ramp_and_drops_what_waits) {
  shape(ShaperKind::kZvd);
  TEST_ASSERT_OK(command(1000));
  const Signal position = signal_from_counts(-123456) + 789;
  axis.reset(position);
  for (int i = 0; i < 200; ++i) TEST_ASSERT_EQUAL_INT64(position, axis.tick());
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kAtRest);
  TEST_ASSERT_OK(command(1000));
  ticks_until_rest();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1000), axis.state().setpoint);
}

TEST_F(StandingAxis, a_shaper_set_before_a_reset_still_takes_effect_without_a_jump) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{11.0, 0.1}, kTick, design));
  TEST_ASSERT_OK(axis.set_shaper(design));
  const Signal position = signal_from_counts(4321);
  axis.reset(position);
  for (int i = 0; i < 100; ++i) TEST_ASSERT_EQUAL_INT64(position, axis.tick());
  TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
}

TEST_F(StandingAxis, a_quick_stop_acts_at_once_keeps_its_limits_and_leaves_a_clean_line) {
  const uint64_t seed = 5;
  TEST_INFO("seed", seed);
  Random random(seed);
  shape(ShaperKind::kZvd);
  for (int i = 0; i < 30; ++i) {
    TEST_INFO("case", i);
    axis.reset(0);
    TEST_ASSERT_OK(command(1700000));
    const int64_t run = random.integer(1, 1590);
    Signal before_that = 0;
    Signal before = 0;
    Signal last = 0;
    for (int64_t tick = 0; tick < run; ++tick) {
      before_that = before;
      before = last;
      last = axis.tick();
    }
    axis.request_stop();
    int64_t velocity = last - before;
    int64_t acceleration = velocity - (before - before_that);
    uint32_t ticks = 0;
    while (axis.state().phase != AxisPhase::kAtRest) {
      const Signal next = axis.tick(false);
      const int64_t change = next - last - velocity;
      TEST_ASSERT_AT_MOST_DOUBLE(40.0 * 4294967296.0 + 1,
                                 change < 0 ? -static_cast<double>(change) : static_cast<double>(change));
      TEST_ASSERT_DOUBLE_WITHIN(2.0 * 4294967296.0 + 1, 0.0, static_cast<double>(change - acceleration));
      acceleration = change;
      velocity = next - last;
      last = next;
      TEST_ASSERT_AT_MOST_INT64(60, ++ticks);
    }
    for (int tick = 0; tick < 200; ++tick) TEST_ASSERT_EQUAL_INT64(last, axis.tick());
    TEST_ASSERT_OK(command(-1000));
    ticks_until_rest();
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(-1000), axis.state().setpoint);
  }
}

TEST_F(StandingAxis, every_kind_of_profile_runs_behind_a_shaper_and_within_its_limits) {
  constexpr int64_t kNodes[] = {0, 0, kTableOne, 0};
  const ProfileTable cubic = {1, 1, kNodes, {1.5, 6.0, 6.0, 12.0}};
  const ProfileKind kinds[] = {ProfileKind::kSin2, ProfileKind::kPoly5, ProfileKind::kPoly7, ProfileKind::kTable};
  shape(ShaperKind::kZv);
  for (int i = 0; i < 8; ++i) {
    TEST_INFO("case", i);
    const ProfileKind kind = kinds[i / 2];
    const int32_t target = i % 2 == 0 ? 123456 : -654321;
    Move move{target, kind, kMoveLimits, 0.0, i % 2 == 0, ProfileDetail{&cubic}};
    MoveReport report{};
    TEST_ASSERT_OK(axis.command(move, &report));
    const Signal start = axis.state().setpoint;
    StreamCheck check(start, signal_from_counts(target) >= start, kMoveLimits, kTick);
    for (uint32_t tick = 1; tick <= report.total_ticks + 3; ++tick) {
      check.next(axis.tick());
      TEST_ASSERT_TRUE((axis.state().phase == AxisPhase::kAtRest) == (tick >= report.total_ticks));
    }
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(target), axis.state().setpoint);
    TEST_ASSERT_TRUE(check.within(axis.shaper().stage_count, move.jerk_limited()));
  }
}

TEST_F(StandingAxis, a_stop_at_rest_does_nothing) {
  axis.request_stop();
  TEST_ASSERT_EQUAL_INT64(0, axis.tick());
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kAtRest);
}

TEST_F(StandingAxis, a_move_planned_before_a_stop_is_dropped) {
  TEST_ASSERT_OK(command(1000));
  axis.request_stop();
  TEST_ASSERT_EQUAL_INT64(0, axis.tick(false));
  TEST_ASSERT_FALSE(axis.pending());
  for (int i = 0; i < 10; ++i) TEST_ASSERT_EQUAL_INT64(0, axis.tick());
}

TEST_F(StandingAxis, the_same_moves_give_the_same_bits_everywhere) {
  // GIVEN moves of every class WHEN the setpoints are hashed (FNV-1a) THEN every machine prints this number
  shape(ShaperKind::kZv);
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  const int32_t targets[] = {1700000, 1, 0, -20000, -19990, 123457};
  for (unsigned i = 0; i < 6; ++i) {
    TEST_ASSERT_OK(command(targets[i], i == 2 ? 2.0 : 0.0, i == 3));
    do {
      uint64_t bits = static_cast<uint64_t>(axis.tick());
      for (int byte = 0; byte < 8; ++byte, bits >>= 8) hash = (hash ^ (bits & 0xFF)) * UINT64_C(0x100000001b3);
    } while (axis.state().phase != AxisPhase::kAtRest);
  }
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(9035037027892945517), hash);
}

#ifndef STILLPOINT_CHIP_TESTS

TEST_HOST_F(StandingAxis, ten_thousand_random_moves_each_end_on_the_count) {
  const uint64_t seed = 10000;
  TEST_INFO("seed", seed);
  Random random(seed);
  shape(ShaperKind::kZvd, 37.3, 0.05);
  int32_t position = 0;
  for (int i = 0; i < 10000; ++i) {
    TEST_INFO("case", i);
    const int32_t target = static_cast<int32_t>(random.integer(-100000, 100000));
    const AxisLimits limits{2e6, random.between(10e6, 40e6), random.between(10e6, 40e6), 2e9};
    const bool trapezoid = random.next() % 3 == 0;
    const bool zero_delay = random.next() % 4 == 0;
    const auto kind = trapezoid ? ProfileKind::kTrapezoid : ProfileKind::kSCurve;
    TEST_ASSERT_OK(axis.command(Move{target, kind, limits, 0.0, zero_delay}, nullptr));
    StreamCheck check(signal_from_counts(position), target >= position, limits, kTick);
    do {
      check.next(axis.tick());
    } while (axis.state().phase != AxisPhase::kAtRest);
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(target), axis.state().setpoint);
    TEST_ASSERT_TRUE(check.within(axis.shaper().stage_count, !trapezoid));
    position = target;
  }
}

#endif
