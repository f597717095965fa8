// SPDX-License-Identifier: Apache-2.0
// Auto-tune from a client's side: from an arm that nobody knows to one that stands still.
#include "tests/firmware/tune_rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr int32_t kTarget = 1700000;

TEST_F(Tunable, the_defaults_tune_the_papers_arm) {
  const double plain = ringing_after_move(kTarget);
  run_to_kept();
  TEST_ASSERT_EQUAL_UINT32(7, get(0x0208));
  TEST_ASSERT_EQUAL_UINT32(100, get(0x0209));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x020A));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x020B));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x020D));  // the accelerometer
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0246));
  TEST_ASSERT_DOUBLE_WITHIN(0.005 * 110000, 110000.0, get_wide(0x0210));
  TEST_ASSERT_DOUBLE_WITHIN(0.1 * 11000, 11000.0, get(0x0212));
  TEST_ASSERT_EQUAL_UINT32(1000, get(0x0213));
  TEST_ASSERT_AT_LEAST_INT64(1, get(0x0214));
  TEST_ASSERT_AT_MOST_INT64(550, get(0x0214));
  TEST_ASSERT_AT_LEAST_INT64(1, get(0x0215));
  TEST_ASSERT_AT_LEAST_INT64(80, get(0x0216));
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x0218));
  TEST_ASSERT_EQUAL_INT64(kTarget * kCount, arm.setpoints.back());  // it is back where it began
  const double shaped = ringing_after_move(0);
  MESSAGE("plain ", plain, " shaped ", shaped);
  TEST_ASSERT_TRUE(shaped < 0.05 * plain);
}

TEST_F(Tunable, what_it_will_do_can_be_read_before_it_moves) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0249, 500));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  const uint32_t travel = get_wide(0x0230);
  const uint32_t velocity = get_wide(0x0232);
  const uint32_t acceleration = get_wide(0x0234);
  const uint32_t jerk = get_wide(0x0236);
  const uint32_t duration_ms = get_wide(0x0238);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0208));
  TEST_ASSERT_TRUE(still());
  TEST_ASSERT_EQUAL_UINT32(100000, travel);
  TEST_ASSERT_AT_LEAST_INT64(1, duration_ms);
  arm.forget();
  reach(TuneState::kProposed);
  int64_t furthest = 0, fastest = 0, steepest = 0, sharpest = 0;
  size_t moving = 0;
  for (size_t i = 3; i < arm.setpoints.size(); ++i) {
    const int64_t* s = &arm.setpoints[i];
    const int64_t v = s[0] - s[-1], a = v - (s[-1] - s[-2]), j = a - (s[-1] - 2 * s[-2] + s[-3]);
    furthest = std::max(furthest, std::abs(s[0]));
    fastest = std::max(fastest, std::abs(v));
    steepest = std::max(steepest, std::abs(a));
    sharpest = std::max(sharpest, std::abs(j));
    moving += v != 0 ? 1U : 0U;
  }
  const auto per_second = [](int64_t difference, double ticks) {
    return static_cast<double>(difference) / static_cast<double>(kCount) * ticks;
  };
  TEST_ASSERT_DOUBLE_WITHIN(1.0, travel, per_second(furthest, 1.0));
  TEST_ASSERT_DOUBLE_WITHIN(0.01 * velocity, velocity, per_second(fastest, 1e3));
  TEST_ASSERT_DOUBLE_WITHIN(0.01 * acceleration, acceleration, per_second(steepest, 1e6));
  TEST_ASSERT_DOUBLE_WITHIN(0.01 * jerk, jerk, per_second(sharpest, 1e9) / 1000.0);
  TEST_ASSERT_DOUBLE_WITHIN(2.0, duration_ms, static_cast<double>(moving));
}

TEST_F(Tunable, the_bump_tunes_without_leading_anywhere) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0201, 2));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0207, 400));  // the band's high end, 40 Hz
  const double plain = ringing_after_move(kTarget);
  arm.forget();
  run_to_kept();
  TEST_ASSERT_EQUAL_UINT32(2, get(0x0247));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x020A));
  TEST_ASSERT_DOUBLE_WITHIN(0.005 * 110000, 110000.0, get_wide(0x0210));
  TEST_ASSERT_DOUBLE_WITHIN(0.1 * 11000, 11000.0, get(0x0212));
  TEST_ASSERT_EQUAL_INT64(kTarget * kCount, arm.setpoints.back());
  const double reached = reach_from(kTarget);
  TEST_ASSERT_AT_LEAST_DOUBLE(10.0, reached);
  TEST_ASSERT_AT_MOST_DOUBLE(get_wide(0x0230) + 1.0, reached);
  const double shaped = ringing_after_move(0);
  MESSAGE("plain ", plain, " shaped ", shaped);
  TEST_ASSERT_TRUE(shaped < 0.05 * plain);
}

// 8 to 40 Hz: half a minute of the stepped sine, three seconds of the chirp.
TEST_F(Tunable, a_sine_and_a_chirp_tune_without_leading_anywhere) {
  for (const uint32_t kind : {3U, 4U}) {
    TEST_INFO(kind, kind);
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0201, kind));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0206, 80));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0207, 400));
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0202, 1000));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0248, 1));
    arm.forget();
    TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
    const uint32_t duration_ms = get_wide(0x0238);
    TEST_ASSERT_AT_LEAST_INT64(2000, duration_ms);
    TEST_ASSERT_TRUE(still());
    for (int i = 0; i < 40000 && tune_state() == TuneState::kExciting; ++i) step();
    for (int i = 0; i < 2 && !ended(); ++i) reach_end();
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, tune_state());
    step();
    TEST_ASSERT_EQUAL_UINT32(kind, get(0x0247));
    TEST_ASSERT_DOUBLE_WITHIN(0.005 * 110000, 110000.0, get_wide(0x0210));
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * 11000, 11000.0, get(0x0212));
    TEST_ASSERT_EQUAL_INT64(0, arm.setpoints.back());
    TEST_ASSERT_AT_MOST_DOUBLE(get_wide(0x0230) + 1.0, reach_from(0));
    TEST_ASSERT_AT_LEAST_INT64(1, axis.shaper().stage_count);
    TEST_ASSERT_EQUAL_UINT32(0, tune(kUndo));
    reach_end();
    TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  }
}

TEST_F(Tunable, what_is_proposed_is_previewed_and_not_yet_in_force) {
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  reach(TuneState::kProposed);
  const uint32_t delay_us = get_wide(0x023A);
  const uint32_t length_us = get_wide(0x023C);
  const uint32_t residual = get(0x020F);
  TEST_ASSERT_EQUAL_UINT32(4, get(0x0208));
  TEST_ASSERT_AT_LEAST_INT64(10000, delay_us);
  TEST_ASSERT_AT_LEAST_INT64(delay_us + 1, length_us);
  TEST_ASSERT_AT_MOST_INT64(200, residual);  // the default tolerance
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  arm.forget();
  step(2000);
  TEST_ASSERT_TRUE(still());
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAccept));
  reach(TuneState::kKept);
  TEST_ASSERT_DOUBLE_WITHIN(2.0, delay_us, get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(length_us / 1000, axis.shaper().length_ticks());
  TEST_ASSERT_AT_LEAST_INT64(1000, get_wide(0x0242));
  TEST_ASSERT_TRUE(get_wide(0x0244) < 0.05 * get_wide(0x0242));
}

TEST_F(Tunable, it_tunes_with_every_kind_of_profile_and_with_zero_delay) {
  for (const uint32_t kind : {0U, 1U, 3U}) {
    for (const uint32_t zero_delay : {0U, 1U}) {
      TEST_INFO("kind", kind);
      TEST_INFO("zero delay", zero_delay);
      TEST_ASSERT_EQUAL_UINT32(0, write_single(0x006A, kind));
      TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0137, zero_delay));
      run_to_kept();
      TEST_ASSERT_DOUBLE_WITHIN(0.005 * 110000, 110000.0, get_wide(0x0210));
      TEST_ASSERT_DOUBLE_WITHIN(0.1 * 11000, 11000.0, get(0x0212));
    }
  }
}

TEST_F(Tunable, it_accepts_by_itself_if_it_is_told_to) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0248, 1));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  reach(TuneState::kKept);
}

// Applied again from its registers it is the same to the bit.
TEST_F(Tunable, what_is_kept_is_staged_as_the_set_in_force) {
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, 3, 0x0006, 0x1A80, 0, 0, 1, 0, 0, 0}));  // set 3, ZV of 40 Hz
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(20);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 0));
  run_to_kept();
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0100));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 3));
  TEST_ASSERT_EQUAL_UINT32(drive.tuning().proposal.spec_count, get(0x0100));
  TEST_ASSERT_DOUBLE_WITHIN(0.2 * 110000, 110000.0, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  const ShaperDesign kept = axis.shaper();
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 5));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 3));
  // A change and back again, so that it is designed again.
  const uint32_t damping = get(0x0104);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0104, damping + 1));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0104, damping));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(200);
  const ShaperDesign again = axis.shaper();
  TEST_ASSERT_EQUAL_UINT32(kept.tap_count, again.tap_count);
  for (uint32_t i = 0; i < kept.tap_count; ++i) {
    TEST_ASSERT_EQUAL_UINT32(kept.taps[i].delay_ticks, again.taps[i].delay_ticks);
    TEST_ASSERT_EQUAL_INT32(kept.taps[i].gain, again.taps[i].gain);
  }
}

TEST_F(Tunable, undo_puts_the_shaper_of_before_back_with_its_registers) {
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, 0, 0x0006, 0x1A80, 0, 0, 1, 0, 0, 0}));  // ZV of 40 Hz
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(20);
  const uint32_t length = axis.shaper().length_ticks();
  run_to_kept();
  TEST_ASSERT_TRUE(axis.shaper().length_ticks() != length);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kUndo));
  reach(TuneState::kUndone);
  TEST_ASSERT_EQUAL_UINT32(length, axis.shaper().length_ticks());
  TEST_ASSERT_EQUAL_UINT32(400000, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_DOUBLE_WITHIN(1000.0, 6000.0, get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(6, tune(kUndo));
  expect_refused(0x9200, 0x0200);
}

TEST_F(Tunable, the_shaper_s_registers_follow_what_runs) {
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, 0, 0x0006, 0x1A80, 0, 0, 1, 0, 0, 0}));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(50);
  const uint32_t delay_us = get_wide(0x0134);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  reach(TuneState::kProposed);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0131));  // excited without one
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAccept));
  reach(TuneState::kVerifying);
  step(1);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(get_wide(0x023A), get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAbort));
  reach(TuneState::kFailed);
  step(1);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(delay_us, get_wide(0x0134));
}

TEST_F(Tunable, undo_of_a_proposal_drops_it) {
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  reach(TuneState::kProposed);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kUndo));
  reach(TuneState::kUndone);
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0100));
  ringing_after_move(1000);
}

TEST_F(Tunable, undo_does_not_touch_a_shaper_that_the_client_applied_since) {
  run_to_kept();
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, 2, 0x0006, 0x1A80, 0, 0, 1, 0, 0, 0}));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(100);
  const uint32_t length = axis.shaper().length_ticks();
  TEST_ASSERT_EQUAL_UINT32(6, tune(kUndo));
  expect_refused(0x9200, 0x0200);
  step(100);
  TEST_ASSERT_EQUAL_UINT32(length, axis.shaper().length_ticks());
}

TEST_F(Tunable, a_second_tuning_goes_out_of_the_first) {
  run_to_kept();
  run_to_kept();
  TEST_ASSERT_DOUBLE_WITHIN(0.005 * 110000, 110000.0, get_wide(0x0210));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kUndo));
  reach(TuneState::kUndone);
  TEST_ASSERT_TRUE(axis.shaper().stage_count != 0);
}

TEST_F(Tunable, at_an_upper_soft_limit_it_goes_down) {
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0074, {0xFFFC, 0xF2C0, 0, 50000}));  // -200,000 to 50,000
  run_to_kept();
  for (const int64_t setpoint : arm.setpoints) TEST_ASSERT_AT_MOST_INT64(0, setpoint);
  TEST_ASSERT_DOUBLE_WITHIN(1.0, 100000.0, reach_from(0));
}

// The axis on its own is the oracle: not a bit of what leaves has to do with the tuner, before or after it was at work.
TEST_F(Tunable, without_a_tuning_the_setpoints_are_the_axis_s_alone) {
  Axis<firmware::kLineCapacity> alone;
  TEST_ASSERT_OK(alone.configure(firmware::kDefaultAxis));
  const auto expect_same_move = [&](int32_t target) {
    arm.forget();
    start_move(target);
    control(0x0F);
    step(3000);
    TEST_ASSERT_OK(alone.command({target, ProfileKind::kSCurve, {1.2e6, 2e7, 2e7, 6e8}, 0.0, false}, nullptr));
    size_t at = 0;
    while (arm.setpoints[at] == arm.setpoints.front()) ++at;
    Signal expected = alone.tick();
    while (expected == arm.setpoints.front()) expected = alone.tick();
    for (; at < arm.setpoints.size(); ++at) {
      if (expected != arm.setpoints[at]) TEST_ASSERT_EQUAL_INT64(expected, arm.setpoints[at]);
      expected = alone.tick();
    }
  };
  expect_same_move(1700000);
  expect_same_move(-3);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  step(300);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAbort));
  reach_end();
  alone.reset(arm.setpoints.back());
  expect_same_move(700000);
}

// Its tip moves with its motor, and the accelerometer has nothing but noise once that stands.
TEST(nothing_is_found_where_nothing_rings) {
  sim::SimulatedDriveConfig rigid = papers_arm();
  rigid.modes = {{{11.0, 0.11}, 1e-9}};
  TuneRig rig(rigid);
  rig.enable();
  TEST_ASSERT_EQUAL_UINT32(0, rig.tune(kStart));
  rig.reach_end();
  TEST_ASSERT_EQUAL_UINT32(9, rig.get(0x0208));
  TEST_ASSERT_TRUE(rig.get(0x020A) != 0);
  TEST_ASSERT_EQUAL_UINT32(0, rig.get(0x020B));
  TEST_ASSERT_EQUAL_UINT32(0, rig.axis.shaper().stage_count);
  TEST_ASSERT_TRUE(rig.reach_from(0) <= 200000.0);
  rig.ringing_after_move(1000);
}

}  // namespace
