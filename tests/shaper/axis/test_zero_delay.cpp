// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/axis.hpp"
#include "shaper/base/math.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;
using stillpoint::testing::StreamCheck;

namespace {

constexpr double kTick = 1e-3;

struct PapersArm {
  Axis<256> axis = {};
  const AxisLimits limits{1.2e6, 20e6, 20e6, 600e6};

  PapersArm() {
    TEST_ASSERT_OK(axis.configure(AxisConfig{kTick, {1e9, 1e12, 1e12, 1e15}, 40e6, 2e9}));
    ShaperDesign design{};
    TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{11.0, 0.11}, kTick, design));
    TEST_ASSERT_OK(axis.set_shaper(design));
    axis.tick();
  }

  Status command(int32_t target_counts, double duration_s, MoveReport& report) {
    return axis.command(Move{target_counts, ProfileKind::kSCurve, limits, duration_s, true}, &report);
  }

  // Runs the move that was accepted and checks the stream that leaves; returns its ticks.
  uint32_t run(int32_t target_counts) { return run(target_counts, limits); }

  uint32_t run(int32_t target_counts, const AxisLimits& kept) {
    const Signal target = signal_from_counts(target_counts);
    StreamCheck check(axis.state().setpoint, target >= axis.state().setpoint, kept, kTick);
    uint32_t last_change = 0;
    Signal last = axis.state().setpoint;
    uint32_t tick = 0;
    do {
      const Signal next = axis.tick();
      ++tick;
      check.next(next);
      if (next != last) last_change = tick;
      last = next;
    } while (axis.state().phase != AxisPhase::kAtRest);
    for (int i = 0; i < 4; ++i) check.next(last);
    TEST_ASSERT_TRUE(check.within(axis.shaper().stage_count));
    TEST_ASSERT_EQUAL_INT64(target, last);
    return last_change;
  }
};

}  // namespace

TEST_F(PapersArm, the_reference_move_ends_shaped_within_the_time_of_the_plain_one) {
  MoveReport report{};
  TEST_ASSERT_OK(command(1700000, 1.62, report));
  TEST_ASSERT_EQUAL_UINT32(1620, report.total_ticks);
  TEST_ASSERT_TRUE(report.zero_delay_met);
  TEST_ASSERT_AT_MOST_INT64(1620, run(1700000));
}

TEST_F(PapersArm, the_papers_own_duration_is_met_too) {
  MoveReport report{};
  TEST_ASSERT_OK(command(1700000, 1.60, report));
  TEST_ASSERT_EQUAL_UINT32(1554, report.profile_ticks);
  TEST_ASSERT_AT_MOST_INT64(1600, run(1700000));
}

TEST_F(PapersArm, what_the_limits_forbid_is_refused_naming_the_limit_and_the_least_duration) {
  MoveReport report{};
  const Status status = command(1700000, 1.53, report);
  TEST_ASSERT_REFUSED(kLimitExceeded, kVelocity, status);
  TEST_ASSERT_FALSE(axis.pending());
  TEST_ASSERT_AT_LEAST_DOUBLE(1.53, status.accepted);
  TEST_ASSERT_AT_MOST_DOUBLE(1.556, status.accepted);
  TEST_ASSERT_OK(command(1700000, status.accepted, report));
  TEST_ASSERT_AT_MOST_DOUBLE(status.accepted / kTick + 1e-6, run(1700000));
  TEST_ASSERT_FALSE(command(0, status.accepted - kTick, report).ok());
}

TEST_F(PapersArm, a_duration_shorter_than_the_shaper_names_the_least) {
  MoveReport report{};
  const Status status = command(1700000, 0.04, report);
  TEST_ASSERT_TRUE(status.error == Error::kLimitExceeded);
  TEST_ASSERT_OK(command(1700000, status.accepted, report));
}

TEST_F(PapersArm, and_one_tick_less_than_that_least_is_refused_with_the_same) {
  MoveReport report{};
  const Status status = command(20000, 0.04, report);
  TEST_ASSERT_REFUSED(kLimitExceeded, kDuration, status);
  const Status shorter = command(20000, status.accepted - kTick, report);
  TEST_ASSERT_REFUSED(kLimitExceeded, kJerk, shorter);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, status.accepted, shorter.accepted);
  TEST_ASSERT_OK(command(20000, status.accepted, report));
  TEST_ASSERT_EQUAL_UINT32(run(20000), report.total_ticks);
}

// The moves of reference.md, 5; S-curve and ZV take 446, 246, 401 and 163, any command 405, 212, 358 and 135.
TEST_F(PapersArm, limits_raised_each_by_its_own_factor_take_fewer_ticks) {
  struct Case {
    int32_t target;
    double jerk;
    uint32_t ticks;
  };
  int32_t at = 0;
  constexpr Case kCases[] = {{500000, 400e6, 426}, {100000, 400e6, 232}, {500000, 4000e6, 399}, {20000, 400e6, 145}};
  for (const Case& each : kCases) {
    TEST_INFO("jerk", each.jerk);
    const AxisLimits asked{2e6, 20e6, 20e6, each.jerk};
    const int32_t target = at + (at == 0 ? each.target : -each.target);
    MoveReport report{};
    TEST_ASSERT_OK(axis.command(Move{target, ProfileKind::kSCurve, asked, 0.0, true}, &report));
    TEST_ASSERT_TRUE(report.timing == MoveTiming::kRaised && report.binding != Quantity::kNone);
    TEST_ASSERT_EQUAL_UINT32(each.ticks, report.total_ticks);
    TEST_ASSERT_EQUAL_UINT32(each.ticks, run(target, asked));
    at = target;
  }
}

TEST_F(PapersArm, room_enough_for_the_shaper_is_used_within_the_profiles_own_limits) {
  MoveReport report{};
  TEST_ASSERT_OK(command(1700000, 1.60, report));
  TEST_ASSERT_TRUE(report.timing == MoveTiming::kWithin);
  TEST_ASSERT_AT_MOST_DOUBLE(limits.velocity, report.peaks.velocity);
  TEST_ASSERT_AT_MOST_DOUBLE(limits.acceleration, report.peaks.acceleration);
  TEST_ASSERT_AT_MOST_DOUBLE(limits.jerk, report.peaks.jerk);
  run(1700000);
}

TEST_F(PapersArm, the_report_says_the_peaks_of_the_stream_that_leaves) {
  constexpr double kDurations[] = {0.0, 0.150};
  for (const double duration : kDurations) {
    TEST_INFO("duration", duration);
    const int32_t target = axis.state().setpoint == 0 ? 20000 : 0;
    MoveReport report{};
    TEST_ASSERT_OK(command(target, duration, report));
    double peaks[3] = {};
    double before[3] = {static_cast<double>(axis.state().setpoint), 0.0, 0.0};
    for (uint32_t i = 0; i < report.total_ticks + 3; ++i) {
      double difference[4] = {static_cast<double>(axis.tick())};
      double scale = kTick * static_cast<double>(kSignalPerCount);
      for (int k = 0; k < 3; ++k) {
        difference[k + 1] = difference[k] - before[k];
        before[k] = difference[k];
        peaks[k] = math::abs(difference[k + 1]) / scale > peaks[k] ? math::abs(difference[k + 1]) / scale : peaks[k];
        scale *= kTick;
      }
    }
    // Doubles hold a setpoint to 1e-16 of itself; its third difference over a tick^3 loses the most.
    TEST_ASSERT_DOUBLE_RELATIVE(1e-6, peaks[0], report.peaks.velocity);
    TEST_ASSERT_DOUBLE_RELATIVE(1e-6, peaks[1], report.peaks.acceleration);
    TEST_ASSERT_DOUBLE_RELATIVE(1e-6, peaks[2], report.peaks.jerk);
  }
}

// Between the least duration and the plain one the stream takes what there is, and has lower peaks for it. (Not the
// lower the longer: how the echoes of the jerks meet changes too.)
TEST_F(PapersArm, room_in_the_wanted_duration_lowers_the_peaks) {
  MoveReport report{};
  TEST_ASSERT_OK(command(20000, 0.0, report));
  TEST_ASSERT_AT_LEAST_DOUBLE(0.95 * limits.jerk, report.peaks.jerk);
  const uint32_t least = run(20000);
  for (uint32_t ticks = least + 6; ticks < 149; ticks += 5) {
    TEST_INFO("ticks", ticks);
    const int32_t target = axis.state().setpoint == 0 ? 20000 : 0;
    TEST_ASSERT_OK(command(target, ticks * kTick, report));
    TEST_ASSERT_TRUE(report.zero_delay_met && report.timing != MoveTiming::kWithin);
    TEST_ASSERT_AT_MOST_DOUBLE(0.9 * limits.jerk, report.peaks.jerk);
    TEST_ASSERT_EQUAL_UINT32(ticks, report.total_ticks);
    TEST_ASSERT_AT_MOST_INT64(ticks, run(target));
  }
}

TEST_F(PapersArm, on_the_stream_the_larger_of_the_two_jerks_is_the_limit) {
  const AxisLimits asked{1.2e6, 20e6, 20e6, 300e6, 900e6};
  MoveReport report{};
  TEST_ASSERT_OK(axis.command(Move{20000, ProfileKind::kSCurve, asked, 0.0, true}, &report));
  TEST_ASSERT_AT_LEAST_DOUBLE(asked.jerk, report.peaks.jerk);
  TEST_ASSERT_AT_MOST_DOUBLE(asked.larger_jerk() * (1.0 + 1e-6), report.peaks.jerk);
  TEST_ASSERT_EQUAL_UINT32(report.total_ticks, run(20000, asked));
}

TEST_F(PapersArm, a_profile_of_minutes_is_not_sped_up_beyond_its_limits) {
  MoveReport report{};
  Status status = axis.command(Move{1000000, ProfileKind::kSCurve, {1e4, 1e5, 1e5, 1e6}, 100.0, true}, &report);
  TEST_ASSERT_REFUSED(kLimitExceeded, kVelocity, status);
  status = axis.command(Move{1000000, ProfileKind::kSCurve, {1e4, 1e5, 1e5, 1e6}, status.accepted, true}, &report);
  TEST_ASSERT_OK(status);
  TEST_ASSERT_EQUAL_UINT32(100200 + 46, report.total_ticks);
}

TEST_F(PapersArm, a_short_move_may_ask_more_of_the_profile_than_of_the_stream) {
  // The plain S-curve takes 117 ticks and the shaper 46; the shaper lowers the peaks, so less than the sum will do.
  MoveReport report{};
  TEST_ASSERT_OK(command(20000, 0.0, report));
  TEST_ASSERT_FALSE(report.zero_delay_met);
  TEST_ASSERT_AT_MOST_INT64(116, report.profile_ticks);
  TEST_ASSERT_AT_LEAST_INT64(125, report.total_ticks);  // what any command needs: tests/sim/test_least_ticks.cpp
  TEST_ASSERT_EQUAL_UINT32(report.total_ticks, run(20000));
}

TEST_F(PapersArm, random_zero_delay_moves_keep_their_limits_or_are_refused_with_a_duration_that_works) {
  const uint64_t seed = 17;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 40; ++i) {
    TEST_INFO("case", i);
    const int32_t target = static_cast<int32_t>(random.integer(-400000, 400000));
    MoveReport report{};
    Status status = command(target, random.between(0.05, 0.8), report);
    if (status.error == Error::kLimitExceeded) status = command(target, status.accepted, report);
    TEST_ASSERT_OK(status);
    TEST_ASSERT_AT_MOST_INT64(report.total_ticks, run(target));
  }
}

// "Limits hold on what leaves": a shaper with negative gains may raise peaks, so its moves are slowed down.
TEST_F(PapersArm, a_shaper_that_raises_peaks_gets_moves_that_keep_the_limits_all_the_same) {
  const uint64_t seed = 33;
  TEST_INFO("seed", seed);
  Random random(seed);
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kUmZv, Mode{11.0, 0.02}, kTick, design));
  TEST_ASSERT_OK(axis.set_shaper(design));
  axis.tick();
  int32_t at = 0;
  for (int i = 0; i < 12; ++i) {
    TEST_INFO("case", i);
    const int32_t target = static_cast<int32_t>(random.integer(-2000000, 2000000));
    const bool zero_delay = i % 3 == 2;
    const AxisLimits asked{limits.velocity, limits.acceleration, limits.deceleration * random.between(0.2, 1.0),
                           limits.jerk};
    MoveReport report{};
    TEST_ASSERT_OK(axis.command(Move{target, ProfileKind::kSCurve, asked, 0.0, zero_delay}, &report));
    StreamCheck check(signal_from_counts(at), target >= at, asked, kTick);
    uint32_t ticks = 0;
    do {
      check.next(axis.tick());
      ++ticks;
    } while (axis.state().phase != AxisPhase::kAtRest);
    for (int k = 0; k < 4; ++k) check.next(axis.state().setpoint);
    TEST_ASSERT_TRUE(check.within(axis.shaper().stage_count));
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(target), axis.state().setpoint);
    TEST_ASSERT_AT_MOST_INT64(report.total_ticks + 1, ticks);
    // Less than twice the plain time: not simply slowed down by the peak gain of three.
    TEST_ASSERT_AT_MOST_DOUBLE(2.0 * report.optimum_ticks + design.length_ticks(), report.total_ticks);
    at = target;
  }
}

// What keeps the limits in one duration need not in a longer one behind gains of one, minus one, one: every duration
// that is taken is kept, and one that is refused names another that is.
TEST_F(PapersArm, behind_negative_gains_every_wanted_duration_keeps_the_limits_or_is_refused_with_one_that_does) {
  const uint64_t seed = 41;
  TEST_INFO("seed", seed);
  Random random(seed);
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kUmZv, Mode{11.0, 0.02}, kTick, design));
  TEST_ASSERT_OK(axis.set_shaper(design));
  axis.tick();
  int refused = 0;
  for (int i = 0; i < 40; ++i) {
    TEST_INFO("case", i);
    const int32_t target = static_cast<int32_t>(random.integer(-300000, 300000));
    Move move{target, ProfileKind::kSCurve, limits, random.between(0.1, 0.8), random.unit() < 0.5};
    move.limits.jerk *= random.between(0.5, 4.0);
    MoveReport report{};
    Status status = axis.command(move, &report);
    if (!status.ok()) {
      ++refused;
      move.duration_s = status.accepted;
      status = axis.command(move, &report);
    }
    TEST_ASSERT_OK(status);
    TEST_ASSERT_AT_MOST_INT64(report.total_ticks, run(target, move.limits));
  }
  TEST_ASSERT_AT_LEAST_INT64(5, refused);
}
