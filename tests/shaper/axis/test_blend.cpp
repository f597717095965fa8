// SPDX-License-Identifier: Apache-2.0
// A change of shaper in motion.
#include "shaper/axis/blend.hpp"

#include "tests/shaper/axis/retuning.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

TEST(a_ramp_is_exact_at_both_ends_and_as_smooth_as_it_says) {
  const int64_t gaps[] = {0, 1, -1, INT64_C(123456789012345), -INT64_C(123456789012345), INT64_MAX / 2, INT64_MIN / 2};
  for (uint32_t order = 0; order <= 7; ++order) {
    TEST_INFO("order", order);
    const double q = static_cast<double>(UINT32_C(1) << order);
    for (unsigned i = 0; i < sizeof gaps / sizeof gaps[0]; ++i) {
      const int64_t gap = gaps[i];
      const double size = gap < 0 ? -static_cast<double>(gap) : static_cast<double>(gap);
      const Signal from = -gap / 3;
      BlendRamp ramp;
      ramp.begin(order);
      Signal last = from;
      int64_t velocity = 0, acceleration = 0;
      uint32_t ticks = 0;
      for (; !ramp.done(); ++ticks) {
        const Signal next = ramp.tick(from, from + gap);
        const int64_t change = next - last - velocity;
        TEST_ASSERT_DOUBLE_WITHIN(size / (2 * q) + 1, 0.0, static_cast<double>(next - last));
        TEST_ASSERT_DOUBLE_WITHIN(size / (2 * q * q) + 2, 0.0, static_cast<double>(change));
        TEST_ASSERT_DOUBLE_WITHIN(size / (2 * q * q * q) + 4, 0.0, static_cast<double>(change - acceleration));
        velocity = next - last;
        acceleration = change;
        last = next;
        if (ticks + 3 >= BlendRamp::ticks(order)) TEST_ASSERT_EQUAL_INT64(from + gap, next);
      }
      TEST_ASSERT_EQUAL_UINT32(BlendRamp::ticks(order), ticks);
    }
  }
}

TEST_F(Retuning, to_a_longer_delay_and_back_in_a_cruise) {
  // GIVEN a cruise at 1,000,000 counts/s, below the limit, in which the two stand 27,000 counts apart
  const ShaperDesign fast = zv(37.0), slow = three_hump_ei(30.0, kTick);
  for (int i = 0; i < 2; ++i) {
    TEST_INFO("way", i);
    start_with(i == 0 ? fast : slow, i == 0 ? slow : fast);
    TEST_ASSERT_OK(move_to(i == 0 ? 1700000 : 0, 1.82));
    // WHEN the shaper is changed in it THEN the new one is in force within the cruise; forward 0.13e6 counts/s are left
    // to catch up with, which takes half a second
    run(i == 0 ? 1700000 : 0, 300, kLimits);
    TEST_ASSERT_TRUE(in_motion);
    TEST_ASSERT_AT_MOST_INT64(i == 0 ? 550 : 850, active_at);
  }
}

TEST_F(Retuning, at_full_speed_slowing_down_has_room_and_speeding_up_waits) {
  const ShaperDesign fast = zv(37.0), slow = three_hump_ei(30.0, kTick);
  start_with(fast, slow);
  TEST_ASSERT_OK(move_to(1700000));
  run(1700000, 300, kLimits);
  TEST_ASSERT_AT_MOST_INT64(800, active_at);
  start_with(slow, fast);
  TEST_ASSERT_OK(move_to(0));
  run(0, 300, kLimits);
  TEST_ASSERT_AT_LEAST_INT64(1400, active_at);
}

TEST_F(Retuning, service_looks_further_where_the_first_search_could_not) {
  // GIVEN a shaper with a negative tap, whose own stream is run to the end of the move, and a move too long for that
  // WHEN `service` is called THEN it is blended in once the end is near enough; otherwise the change waits for rest
  ShaperDesign overshooting = zv(37.0);
  overshooting.taps[0].gain += kUnityGain / 2;
  overshooting.taps[1].gain -= kUnityGain / 2;
  overshooting.taps[1].gain -= overshooting.taps[2].gain / 2;
  overshooting.taps[2].gain -= overshooting.taps[2].gain / 2;
  const int32_t rest = kUnityGain - overshooting.taps[0].gain - overshooting.taps[1].gain - overshooting.taps[2].gain;
  overshooting.taps[0].gain += rest;
  TEST_ASSERT_TRUE(overshooting.taps[1].gain < 0);
  for (int i = 0; i < 2; ++i) {
    start_with(three_hump_ei(30.0, kTick), overshooting);
    const int32_t target = i == 0 ? 7200000 : 0;
    TEST_ASSERT_OK(move_to(target, 14.0));
    run(target, 300, kLimits, i == 0);
    TEST_ASSERT_TRUE(in_motion == (i == 0));
    if (i == 0) TEST_ASSERT_AT_LEAST_INT64(14000 - kLongestBlendProofTicks, active_at);
  }
}

TEST_F(Retuning, a_shaper_that_would_itself_break_a_limit_further_on_is_not_blended_in) {
  // GIVEN gains of -0.2 and 1.2, 40 ticks apart: nothing in a cruise, 1.2 times the deceleration in braking
  const int32_t fifth = kUnityGain / 5;
  const ShaperDesign sharp{1, 3, {{0, 3}}, {{0, -fifth}, {40, kUnityGain + fifth}, {41, 0}}};
  start_with(ShaperDesign{}, sharp);
  TEST_ASSERT_OK(move_to(1700000));
  run(1700000, 300, kLimits);
  TEST_ASSERT_FALSE(in_motion);
  // AND a move that leaves a third for it
  start_with(ShaperDesign{}, sharp);
  TEST_ASSERT_OK(move_to(0, 1.82));
  run(0, 300, kLimits);
  TEST_ASSERT_TRUE(in_motion);
}

TEST_F(Retuning, a_window_that_the_tick_missed_is_looked_for_again) {
  // GIVEN a window that was found WHEN no commit comes for a while THEN the change is taken in time or not at all
  const ShaperDesign fast = zv(37.0), slow = three_hump_ei(30.0, kTick);
  for (int withheld = 0; withheld <= 300; withheld += withheld < 100 ? 4 : 100) {
    TEST_INFO("withheld", withheld);
    start_with(fast, slow);
    const Signal start = axis.state().setpoint;
    const int32_t target = start == 0 ? 1700000 : 0;
    TEST_ASSERT_OK(move_to(target, 1.82));
    StreamCheck check(start, target != 0, kLimits, kTick);
    for (int i = 0; i < 300; ++i) check.next(step());
    TEST_ASSERT_OK(axis.set_shaper(slow, Retune::kBlended));
    for (int i = 0; i < withheld; ++i) check.next(step(false));
    TEST_ASSERT_TRUE(axis.pending());
    while (axis.state().phase != AxisPhase::kAtRest) {
      axis.service();
      check.next(step());
    }
    TEST_ASSERT_TRUE(check.within(stages()));
    TEST_ASSERT_TRUE(in_motion);
    TEST_ASSERT_AT_MOST_INT64(700 + withheld, active_at);
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(target), axis.state().setpoint);
  }
}

TEST_F(Retuning, everything_else_is_refused_until_the_blend_is_over) {
  start_with(zv(37.0), three_hump_ei(30.0, kTick));
  TEST_ASSERT_OK(move_to(1700000, 1.82));
  for (int i = 0; i < 300; ++i) step();
  TEST_ASSERT_REFUSED(kBusy, kNone, axis.set_shaper(after));
  TEST_ASSERT_OK(axis.set_shaper(after, Retune::kBlended));
  while (axis.pending()) {
    TEST_ASSERT_TRUE(same(axis.shaper(), before));
    TEST_ASSERT_REFUSED(kBusy, kNone, axis.set_shaper(after, Retune::kBlended));
    TEST_ASSERT_REFUSED(kBusy, kNone, move_to(0));
    step();
  }
  TEST_ASSERT_TRUE(same(axis.shaper(), after));
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kMoving);
  ShaperDesign long_one = zv(1.0);
  TEST_ASSERT_REFUSED(kLineTooShort, kDelay, axis.set_shaper(long_one, Retune::kBlended));
  TEST_ASSERT_FALSE(axis.pending());
}

TEST_F(Retuning, at_rest_a_blended_change_is_one_at_rest) {
  start_with(zv(37.0), three_hump_ei(30.0, kTick));
  TEST_ASSERT_OK(axis.set_shaper(after, Retune::kBlended));
  axis.tick();
  TEST_ASSERT_TRUE(same(axis.shaper(), after));
}

TEST_F(Retuning, a_stop_or_a_reset_drops_the_blend_and_rest_brings_the_new_shaper) {
  // GIVEN a change asked for at 300 WHEN a stop or a reset comes before, within and after the blend
  for (int when = 305; when < 560; when += 9) {
    for (int reset = 0; reset < 2; ++reset) {
      TEST_INFO("tick", when);
      start_with(zv(37.0), three_hump_ei(30.0, kTick));
      const Signal start = axis.state().setpoint;
      TEST_ASSERT_OK(move_to(start < 0 ? 1700000 : -1700000, 2.82 + 1e-3 * reset));
      StreamCheck check(start, start < 0, AxisLimits{1.2e6, 40e6, 40e6, 2e9}, kTick);
      for (int i = 0; i < when; ++i) {
        if (i == 300) TEST_ASSERT_OK(axis.set_shaper(after, Retune::kBlended));
        check.next(step());
      }
      if (reset == 1) {
        axis.reset(signal_from_counts(1234));
      } else {
        axis.request_stop();
        do check.next(axis.tick());
        while (axis.state().phase != AxisPhase::kAtRest);
        TEST_ASSERT_TRUE(check.within(stages()));
      }
      // THEN the axis stands, under the new shaper, and its next move is shaped by that alone
      const Signal stands = axis.state().setpoint;
      for (int i = 0; i < 5; ++i) TEST_ASSERT_EQUAL_INT64(stands, axis.tick());
      TEST_ASSERT_FALSE(axis.pending());
      TEST_ASSERT_TRUE(same(axis.shaper(), after));
      start_with(after, after);
      TEST_ASSERT_OK(move_to(5000));
      do step();
      while (axis.state().phase != AxisPhase::kAtRest);
    }
  }
}
