// SPDX-License-Identifier: Apache-2.0
// The main job through the client's door: a shaper set, a move commanded, its end seen.
#include <cmath>

#include "tests/firmware/rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kTargetReached = 1U << 10;
constexpr uint32_t kTaken = 1U << 12;
constexpr int64_t kCount = int64_t{1} << 32;

struct Shaping : Rig {
  // Li's arm: 11 Hz, 0.11.
  void stage(uint32_t kind, uint32_t frequency = 110000, uint32_t damping = 11000, uint32_t mode = 0) {
    const auto first = static_cast<uint16_t>(0x0102 + 8 * mode);
    const std::vector<uint16_t> words = {static_cast<uint16_t>(frequency >> 16),
                                         static_cast<uint16_t>(frequency),
                                         static_cast<uint16_t>(damping),
                                         0,
                                         static_cast<uint16_t>(kind),
                                         0,
                                         0,
                                         0};
    TEST_ASSERT_EQUAL_UINT32(0, write(first, words));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, mode + 1));
  }
  void apply() {
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    for (int i = 0; i < 50 && get(0x0131) == 2; ++i) step();
  }
  void move(int32_t target) {
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, target));
    control(0x1F);
    TEST_ASSERT_EQUAL_UINT32(kTaken, status() & kTaken);
    control(0x0F);
  }
  // Ticks of the last move, from the first setpoint that changes to the last.
  uint32_t run_to_the_end() {
    const size_t begin = servo.commands.size() < 100 ? 1 : servo.commands.size() - 100;
    for (int i = 0; (drive.drive().statusword() & kTargetReached) == 0; ++i) {
      TEST_ASSERT_TRUE(i < 10000);
      step();
    }
    size_t first = 0;
    size_t last = 0;
    for (size_t i = begin; i < servo.commands.size(); ++i) {
      if (servo.commands[i].setpoint == servo.commands[i - 1].setpoint) continue;
      if (first == 0) first = i;
      last = i;
    }
    return static_cast<uint32_t>(last - first + 1);
  }
  // What the stream leaves an undamped-free arm of Li's mode swinging with, relative to the move: the amplitude of
  // sum x_i p^-i over the stream's steps, by its own arithmetic.
  double residual(double frequency, double damping) {
    const long double w = 2.0L * 3.14159265358979323846L * static_cast<long double>(frequency);
    const long double wd = w * sqrtl(1.0L - static_cast<long double>(damping) * static_cast<long double>(damping));
    long double re = 0;
    long double im = 0;
    const size_t end = servo.commands.size();
    for (size_t i = 1; i < end; ++i) {
      const auto change = static_cast<long double>(servo.commands[i].setpoint - servo.commands[i - 1].setpoint);
      const long double back = static_cast<long double>(end - i) * 1e-3L;
      const long double weight = change / 4294967296.0L * expl(-static_cast<long double>(damping) * w * back);
      re += weight * cosl(wd * back);
      im += weight * sinl(wd * back);
    }
    const long double decay = static_cast<long double>(damping) * w * 1e-3L;
    return static_cast<double>(sqrtl(re * re + im * im) * expl(decay));
  }
};

TEST_F(Shaping, an_applied_shaper_becomes_active_with_its_delay) {
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0131));
  stage(1);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0131));  // staged is not applied
  apply();
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  // ZV, 11 Hz, 0.11: second impulse of weight K/(1+K), K = exp(-0.11 pi / sqrt(1 - 0.11^2)) = 0.7065, at 45.73 ms.
  TEST_ASSERT_DOUBLE_WITHIN(60.0, 18932.0, get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
}

TEST_F(Shaping, an_apply_without_a_mode_turns_shaping_off) {
  stage(2);
  apply();
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(2, axis.shaper().stage_count);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 0));
  apply();
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
}

TEST_F(Shaping, a_shaper_waits_for_the_commit) {
  servo.commit = false;
  step(2);
  stage(1);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(100);
  TEST_ASSERT_EQUAL_UINT32(2, get(0x0131));
  servo.commit = true;
  step(3);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
}

TEST_F(Shaping, the_last_of_two_applies_wins_though_it_asks_for_what_is_still_in_force) {
  servo.commit = false;
  step(2);
  stage(1);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 0));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  TEST_ASSERT_EQUAL_UINT32(2, get(0x0131));
  servo.commit = true;
  step(10);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  TEST_ASSERT_FALSE(axis.pending());
}

TEST_F(Shaping, a_shaper_applied_while_moving_takes_effect_when_the_axis_stands) {
  enable();
  move(300000);
  stage(1);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(20);
  TEST_ASSERT_EQUAL_UINT32(2, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  run_to_the_end();
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_EQUAL_INT64(300000 * kCount, servo.setpoint());
}

TEST_F(Shaping, a_shaper_applied_blended_takes_over_in_the_move) {
  enable();
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0138, 2500));
  move(1700000);
  stage(1);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 2));
  TEST_ASSERT_EQUAL_UINT32(2, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  step(600);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kMoving);
  TEST_ASSERT_DOUBLE_WITHIN(60.0, 18932.0, get_wide(0x0134));
  run_to_the_end();
  TEST_ASSERT_EQUAL_INT64(1700000 * kCount, servo.setpoint());
}

TEST_F(Shaping, a_blend_without_room_waits_for_rest_and_says_pending) {
  stage(1);
  apply();
  enable();
  move(1700000);  // in the least time: nowhere may it go faster, and a shorter delay has to be caught up
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 0));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 2));
  while (axis.state().phase != AxisPhase::kAtRest) {
    TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
    step();
  }
  TEST_ASSERT_EQUAL_INT64(1700000 * kCount, servo.setpoint());
  step();
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
}

TEST_F(Shaping, a_quick_stop_does_not_lose_a_shaper_on_its_way) {
  enable();
  move(300000);
  stage(1);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  control(0x02);
  step(100);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
}

TEST_F(Shaping, a_quick_stop_does_not_lose_a_shaper_that_is_being_blended_in) {
  for (uint32_t ticks = 0; ticks < 200; ticks += 20) {
    TEST_INFO("ticks", ticks);
    Shaping one;
    one.enable();
    TEST_ASSERT_EQUAL_UINT32(0, one.write_wide(0x0138, 2500));
    one.move(1700000);
    one.stage(1);
    TEST_ASSERT_EQUAL_UINT32(0, one.write_single(0x0130, 2));
    one.step(ticks);
    one.control(0x02);
    one.step(200);
    TEST_ASSERT_EQUAL_UINT32(1, one.get(0x0131));
    TEST_ASSERT_EQUAL_UINT32(1, one.axis.shaper().stage_count);
  }
}

TEST_F(Shaping, a_set_point_waits_for_the_shaper_on_its_way) {
  enable();
  servo.commit = false;
  step(2);
  stage(1);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, 10000));
  control(0x1F);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0012));
  servo.commit = true;
  step(5);
  TEST_ASSERT_EQUAL_UINT32(kTaken, status() & kTaken);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
}

TEST_F(Shaping, a_mode_that_the_tick_cannot_realise_is_refused_by_name_and_the_old_shaper_stays) {
  stage(1);
  apply();
  stage(1, 3000000, 0, 1);  // 300 Hz: fine
  apply();
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(2, axis.shaper().stage_count);
  stage(4, 5000, 0, 1);  // ZVDDD of 0.5 Hz: 4000 ticks
  apply();
  TEST_ASSERT_EQUAL_UINT32(3, get(0x0131));
  const uint32_t reason = get(0x0132);
  TEST_ASSERT_TRUE(reason != 0);
  TEST_ASSERT_EQUAL_UINT32(reason, get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(2, axis.shaper().stage_count);
}

TEST_F(Shaping, a_shaper_too_long_for_the_line_is_refused_with_a_frequency_that_is_not) {
  stage(3, 5000, 0);  // ZVDD of 0.5 Hz: 3000 ticks
  apply();
  TEST_ASSERT_EQUAL_UINT32(3, get(0x0131));
  TEST_ASSERT_EQUAL_ENUM(Error::kLineTooShort, get(0x0132) >> 8);
  TEST_ASSERT_EQUAL_UINT32(0x0102, get(0x0013));
  const uint32_t lowest = get_wide(0x0016);
  TEST_ASSERT_AT_LEAST_INT64(5001, lowest);
  TEST_ASSERT_AT_MOST_INT64(7500, lowest);
  stage(3, lowest, 0);
  apply();
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
}

TEST_F(Shaping, discard_puts_back_what_is_in_force) {
  stage(1);
  apply();
  stage(2, 370000, 5000, 1);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 3));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0100));
  TEST_ASSERT_EQUAL_UINT32(110000, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x010A));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
}

// The whole way, as a client goes it. Still: the arm's own mode is left with less than a millionth of the plain move's.
TEST_F(Shaping, the_reference_move_ends_on_its_target_and_leaves_the_arm_still) {
  enable();
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0138, 1620));
  move(1700000);
  TEST_ASSERT_EQUAL_UINT32(1620, run_to_the_end());
  TEST_ASSERT_EQUAL_INT64(1700000 * kCount, servo.setpoint());
  const double plain = residual(11.0, 0.11);

  servo.commands.erase(servo.commands.begin(), servo.commands.end() - 1);
  stage(1);
  apply();
  move(0);
  const uint32_t shaped_ticks = run_to_the_end();
  TEST_ASSERT_EQUAL_UINT32(get_wide(0x013C), shaped_ticks);
  TEST_ASSERT_EQUAL_UINT32(1620 + 46, shaped_ticks);
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());
  TEST_ASSERT_AT_LEAST_DOUBLE(100.0, plain);
  TEST_ASSERT_AT_MOST_DOUBLE(1e-6 * plain, residual(11.0, 0.11));
}

TEST_F(Shaping, with_zero_delay_the_shaped_reference_move_takes_no_longer) {
  enable();
  stage(1);
  apply();
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0137, {1, 0, 1620}));
  move(1700000);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x013E));
  const uint32_t ticks = run_to_the_end();
  TEST_ASSERT_AT_MOST_INT64(1620, ticks);
  TEST_ASSERT_EQUAL_INT64(1700000 * kCount, servo.setpoint());
}

TEST_F(Shaping, a_zero_delay_that_the_limits_forbid_is_refused_with_the_least_duration_and_that_is_taken) {
  enable();
  stage(1);
  apply();
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0137, {1, 0, 1300}));
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, 1700000));
  control(0x1F);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  TEST_ASSERT_EQUAL_ENUM(Error::kLimitExceeded, get(0x0012) >> 8);
  TEST_ASSERT_EQUAL_UINT32(0x0138, get(0x0013));
  const uint32_t least = get_wide(0x0016);
  TEST_ASSERT_AT_LEAST_INT64(1400, least);
  TEST_ASSERT_AT_MOST_INT64(1600, least);
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0138, least));
  move(1700000);
  TEST_ASSERT_AT_MOST_INT64(least, run_to_the_end());
}

TEST_F(Shaping, the_setpoints_do_not_depend_on_when_the_client_is_served) {
  enable();
  stage(1);
  apply();
  move(123457);
  run_to_the_end();
  const auto changes = [](const std::vector<hal::ServoCommand>& commands) {
    std::vector<int64_t> stream;
    for (size_t i = 1; i < commands.size(); ++i) {
      if (commands[i].setpoint != commands[i - 1].setpoint) stream.push_back(commands[i].setpoint);
    }
    return stream;
  };
  const std::vector<int64_t> first = changes(servo.commands);
  TEST_ASSERT_AT_LEAST_INT64(200, static_cast<int64_t>(first.size()));

  Shaping other;
  other.enable();
  other.stage(1);
  other.apply();
  other.move(123457);
  for (int i = 0; i < 2000; ++i) {
    other.drive.tick();
    if (i % 7 == 0) other.drive.poll();
  }
  TEST_ASSERT_TRUE(first == changes(other.servo.commands));
}

}  // namespace
