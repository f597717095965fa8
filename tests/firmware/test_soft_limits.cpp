// SPDX-License-Identifier: Apache-2.0
// The fault of a soft limit: how far beyond it comes, and the way back.
#include "tests/firmware/drive402.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::testing;

// Soft limits of -+ 1000 counts, and the motor where it is pushed to by hand.
struct Limited : Drive402 {
  Limited() { limit(-1000, 1000); }
  void limit(int32_t low, int32_t high) {
    unlock();
    const auto word = [](int32_t value, int shift) { return static_cast<uint16_t>(value >> shift); };
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0074, {word(low, 16), word(low, 0), word(high, 16), word(high, 0)}));
  }
  void push_to(int32_t counts) {
    servo.encoder_off = counts * kCount - servo.position;
    step(100);
  }
};

TEST_F(Limited, no_register_without_a_lock_opens_the_soft_limits) {
  step(61000);
  TEST_ASSERT_EQUAL_UINT32(6, write_wide(0x0076, 5));
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0070, UINT32_MAX));
  enable();
  push_to(1100);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
  push_to(1101);
  TEST_ASSERT_EQUAL_UINT32(0x8612, get(0x0010));
}

TEST_F(Limited, a_window_narrower_than_the_margin_narrows_it) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0070, 3));
  enable();
  push_to(-1003);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
  push_to(-1004);
  TEST_ASSERT_EQUAL_UINT32(0x8612, get(0x0010));
}

constexpr uint32_t kBeyondLimit = 8;          // 0011
constexpr uint32_t kInternalLimit = 1 << 11;  // statusword

// Beyond a limit, in counts, before it is enabled.
struct Outside : Limited {
  void stand_at(int32_t counts) {
    servo.encoder_off = 0;
    servo.position = counts * kCount;
    step(5);
  }
  void expect_enabled_and_beyond(bool beyond) {
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
    TEST_ASSERT_EQUAL_UINT32(0x0027, state());
    TEST_ASSERT_EQUAL_UINT32(beyond ? kBeyondLimit : 0, get(0x0011));
    TEST_ASSERT_EQUAL_UINT32(beyond ? kInternalLimit | 0x80 : 0, status() & (kInternalLimit | 0x80));
  }
  // As somebody would who was left there.
  void come_back(int32_t to) {
    expect_enabled_and_beyond(true);
    start_move(to);
    control(0x0F);
    step(500);
    TEST_ASSERT_EQUAL_INT64(to * kCount, servo.setpoint());
    expect_enabled_and_beyond(false);
  }
  void reset() {
    control(0x00);
    control(0x80);
    control(0x00);
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
  }
};

TEST_F(Outside, an_axis_pushed_out_while_off_is_enabled_there_and_comes_back) {
  for (const int32_t at : {1500, -20000}) {
    TEST_INFO("at", at);
    stand_at(at);
    TEST_ASSERT_EQUAL_UINT32(kBeyondLimit, get(0x0011));
    enable();
    step(200);
    TEST_ASSERT_EQUAL_INT64(at * kCount, servo.setpoint());
    come_back(0);
    // Inside again the limit is what it was.
    push_to(at > 0 ? 1101 : -1101);
    TEST_ASSERT_EQUAL_UINT32(0x8612, get(0x0010));
    servo.encoder_off = 0;
    reset();
  }
}

TEST_F(Outside, after_the_fault_a_reset_is_enough_to_come_back) {
  enable();
  push_to(2000);
  TEST_ASSERT_EQUAL_UINT32(0x8612, get(0x0010));
  TEST_ASSERT_FALSE(servo.enabled());
  stand_at(2000);
  reset();
  enable();
  step(200);
  come_back(1000);
}

TEST_F(Outside, further_out_is_refused_to_a_move_and_a_fault_where_it_is_pushed) {
  stand_at(1500);
  enable();
  for (const int32_t target : {1400, 1600}) {
    start_move(target);
    TEST_ASSERT_EQUAL_UINT32(0x0044, get(0x0013));
    TEST_ASSERT_EQUAL_UINT32(1000, get_wide(0x0016));
    control(0x0F);
  }
  TEST_ASSERT_EQUAL_INT64(1500 * kCount, servo.setpoint());
  push_to(1600);
  expect_enabled_and_beyond(true);
  push_to(1601);
  TEST_ASSERT_EQUAL_UINT32(0x8612, get(0x0010));
  TEST_ASSERT_FALSE(servo.enabled());
}

TEST_F(Outside, the_velocity_mode_goes_inwards_to_the_other_limit_and_not_further_out) {
  stand_at(1500);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 3));
  enable();
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0052, 10000));
  step(200);
  TEST_ASSERT_EQUAL_INT64(1500 * kCount, servo.setpoint());
  expect_enabled_and_beyond(true);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0052, -10000));
  step(600);
  TEST_ASSERT_EQUAL_INT64(-1000 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0011));
  TEST_ASSERT_EQUAL_UINT32(kInternalLimit, status() & (kInternalLimit | 0x80));  // it holds the velocity asked for
}

TEST_F(Outside, limits_drawn_in_past_an_enabled_axis_let_it_come_back) {
  limit(-9000, 9000);
  stand_at(5000);
  enable();
  limit(-1000, 1000);
  step(200);
  come_back(1000);
}

TEST_F(Outside, a_homing_to_where_the_limits_are_not_lets_it_come_back) {
  limit(1000, 5000);
  stand_at(3000);
  enable();
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 6));
  step(5);
  control(0x1F);
  control(0x0F);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x0046));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  step(5);
  expect_enabled_and_beyond(true);
  start_move(1000);
  control(0x0F);
  step(500);
  TEST_ASSERT_EQUAL_UINT32(1000, get_wide(0x0046));
  expect_enabled_and_beyond(false);
}

}  // namespace
