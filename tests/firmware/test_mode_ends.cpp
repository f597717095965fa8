// SPDX-License-Identifier: Apache-2.0
// What a stop, a fault or a change of mode ends, it ends: nothing of it comes back by itself.
#include "tests/firmware/modes402.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::testing;

TEST_F(Streamed, a_fault_of_the_stream_is_over_once_it_is_reset) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0089, 1));
  TEST_ASSERT_EQUAL_UINT32(0, send_positions({0, 2000000}));
  control(0x1F);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0xFF01, get(0x0010));
  for (const uint32_t policy : std::initializer_list<uint32_t>{0, 1}) {
    TEST_INFO("policy", policy);
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0089, policy));
    control(0x80);
    enable();
    const auto stands = static_cast<int32_t>(get_wide(0x004A));
    TEST_ASSERT_EQUAL_UINT32(0, send_positions({stands, stands, stands, stands + 10, stands + 20, stands + 20}));
    control(0x1F);
    step(200);
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
    TEST_ASSERT_EQUAL_INT32(stands + 20, get_wide(0x004A));
    control(0x0F);
    step(50);
    control(0x00);
  }
}

// The ramp of disable operation (7) takes 4 s here.
TEST_F(Velocity, a_velocity_written_while_disabling_is_not_run) {
  for (const bool on_again : std::initializer_list<bool>{false, true}) {
    TEST_INFO("enabled again on the way", on_again);
    Velocity rig;
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0064, 100000));
    rig.velocity(400000);
    rig.step(200);
    rig.control(0x07);
    rig.velocity(500000);
    rig.step(100);
    double before = rig.speed();
    TEST_ASSERT_AT_MOST_DOUBLE(400000.0, before);
    if (on_again) rig.control(0x0F);
    for (int i = 0; i < 50; ++i) {
      rig.step(100);
      TEST_ASSERT_AT_MOST_DOUBLE(before, rig.speed());
      before = rig.speed();
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, before);
    TEST_ASSERT_TRUE(rig.servo.enabled() == on_again);
    TEST_ASSERT_EQUAL_UINT32(on_again ? 0x0027 : 0x0023, rig.state());
    rig.control(0x0F);
    TEST_ASSERT_EQUAL_UINT32(0x0027, rig.state());
    TEST_ASSERT_EQUAL_INT32(0, rig.get_wide(0x0052));
    rig.step(200);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, rig.speed());
    rig.velocity(300000);
    rig.step(200);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 300000.0, rig.speed());
  }
}

TEST_F(Enabled402, a_set_point_given_while_disabling_is_lost) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0064, 1000000));
  start_move(1700000);
  control(0x0F);
  step(500);
  control(0x07);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, -500000));
  control(0x37);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  int64_t highest = servo.setpoint();
  for (int i = 0; i < 1600; ++i) {
    step();
    TEST_ASSERT_AT_LEAST_INT64(highest, servo.setpoint());
    highest = servo.setpoint();
  }
  TEST_ASSERT_EQUAL_UINT32(0x0023, state());
  control(0x3F);  // the bit was up before
  step(500);
  TEST_ASSERT_EQUAL_UINT32(0x0027, state());
  TEST_ASSERT_EQUAL_INT64(highest, servo.setpoint());
}

TEST_F(Enabled402, enable_operation_on_the_way_keeps_the_drive_on_and_takes_no_set_point) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0064, 1000000));
  start_move(1700000);
  control(0x0F);
  step(500);
  control(0x07);
  control(0x17);
  control(0x0F);
  control(0x07);
  control(0x1F);
  step(2000);
  TEST_ASSERT_EQUAL_UINT32(0x0027, status() & (0x006F | kTaken | kTargetReached));
  const int64_t stood = servo.setpoint();
  TEST_ASSERT_TRUE(stood < 1700000 * kCount);
  control(0x0F);
  control(0x1F);
  step(2500);
  TEST_ASSERT_EQUAL_INT64(1700000 * kCount, servo.setpoint());
}

// Also where it comes just before the tick that would begin it; one poll a tick, so that nothing mends that before.
TEST_F(Enabled402, a_halt_drops_the_set_point_that_is_kept) {
  uint32_t at_rest = 0;
  for (uint32_t wait = 0; wait < 12; ++wait) {
    TEST_INFO("ticks before the halt", wait);
    Enabled402 rig;
    const auto tick = [&] {
      rig.drive.tick();
      rig.drive.own_timer_tick();
      rig.drive.poll();
    };
    rig.start_move(10000);
    rig.control(0x0F);
    rig.start_move(200000);
    for (uint32_t i = 0; i < wait; ++i) tick();
    rig.send(framed({1, 6, 0, 0x40, 1, 0x0F}));
    while (rig.drive.drive().may_move()) tick();
    const bool stood = rig.servo.setpoint() == 10000 * kCount;
    at_rest += stood ? 1U : 0U;
    for (int i = 0; i < 300; ++i) {
      tick();
      if (stood) TEST_ASSERT_EQUAL_INT64(10000 * kCount, rig.servo.setpoint());
    }
    rig.answer();
    const int64_t stands = rig.servo.setpoint();
    rig.control(0x0F);
    rig.step(300);
    TEST_ASSERT_EQUAL_INT64(stands, rig.servo.setpoint());
  }
  TEST_ASSERT_AT_LEAST_INT64(1, at_rest);
}

// Begun within the last 100 ms of a link that then dies: the fault comes first.
TEST_F(Homing, what_a_fault_came_before_is_not_done_after_it) {
  for (const uint32_t mode : std::initializer_list<uint32_t>{1, 6, 8}) {
    TEST_INFO("mode", mode);
    InMode rig(1);
    rig.start_move(100000);
    rig.control(0x0F);
    rig.step(1500);
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0042, mode));
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0044, 50000));
    if (mode == 8) TEST_ASSERT_EQUAL_UINT32(0, rig.write(0x0090, {1, 0x86A0, 1, 0x86A8, 1, 0x86B0, 1, 0x86B0}));
    rig.send(framed({1, 6, 0, 0x40, 0, 0x1F}));
    rig.step_silent(20);
    rig.answer();
    TEST_ASSERT_EQUAL_UINT32(0x0027, rig.drive.drive().statusword() & 0x006F);
    rig.step_silent(1100);
    rig.control(0x80);
    TEST_ASSERT_EQUAL_UINT32(0x0040, rig.status() & 0x004F);
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0042, 1));
    rig.enable();
    rig.step(500);
    TEST_ASSERT_EQUAL_INT32(100000, rig.get_wide(0x0046));
    TEST_ASSERT_EQUAL_INT64(100000 * kCount, rig.servo.setpoint());
    TEST_ASSERT_EQUAL_UINT32(1, rig.get(0x0043));
  }
}

// The same with a stop instead of the fault, and the link back in time.
TEST_F(Homing, what_a_stop_came_before_is_not_done_after_it) {
  for (const uint8_t word : Bytes{0x00, 0x02, 0x06, 0x07}) {
    TEST_INFO("controlword", word);
    Homing rig;
    rig.unlock();
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0078, 6));
    rig.control(0x00);
    rig.servo.position = 700 * kCount;
    rig.step(5);
    rig.enable();
    for (const uint8_t next : Bytes{0x1F, word}) {
      rig.send(framed({1, 6, 0, 0x40, 0, next}));
      rig.step_silent(20);
      rig.answer();
    }
    rig.step(50);
    TEST_ASSERT_EQUAL_INT32(700, rig.get_wide(0x0046));
    TEST_ASSERT_EQUAL_UINT32(0, rig.status() & kBit12);
    rig.control(0x00);
    rig.enable();
    rig.step(50);
    TEST_ASSERT_EQUAL_INT32(700, rig.get_wide(0x0046));
  }
}

TEST_F(Streamed, what_waits_is_dropped_by_another_mode_and_by_enabling) {
  for (const bool enabling : std::initializer_list<bool>{false, true}) {
    TEST_INFO("enabling", enabling);
    Streamed rig;
    TEST_ASSERT_EQUAL_UINT32(0, rig.send_positions(rig.swings(0, 31)));
    if (enabling) {
      rig.control(0x00);
      TEST_ASSERT_EQUAL_UINT32(31, rig.get(0x008A));
      rig.enable();
    } else {
      TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0042, 1));
      rig.step(5);
      TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0042, 8));
    }
    TEST_ASSERT_EQUAL_UINT32(0, rig.get(0x008A));
    TEST_ASSERT_EQUAL_UINT32(128, rig.get(0x008B));
    rig.control(0x1F);
    rig.step(500);
    TEST_ASSERT_EQUAL_UINT32(0x8601, rig.get(0x0012));
    TEST_ASSERT_EQUAL_INT64(0, rig.servo.setpoint());
    rig.control(0x0F);
    TEST_ASSERT_EQUAL_UINT32(0, rig.send_positions({0, 0, 5, 5}));
    rig.control(0x1F);
    rig.step(100);
    TEST_ASSERT_EQUAL_INT64(5 * kCount, rig.servo.setpoint());
  }
}

TEST_F(Streamed, written_in_another_mode_they_are_not_of_this_one) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  step(5);
  TEST_ASSERT_EQUAL_UINT32(0, send_positions({0, 0, 500}));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 8));
  step(5);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x008A));
}

TEST_F(Enabled402, a_kept_set_point_that_is_refused_in_its_turn_is_as_if_it_had_not_been_given) {
  for (const bool bit_stays : std::initializer_list<bool>{false, true}) {
    TEST_INFO("bit 4 stays up", bit_stays);
    Enabled402 rig;
    rig.start_move(400000);
    rig.control(0x0F);
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0138, 1));
    rig.start_move(800000);
    TEST_ASSERT_EQUAL_UINT32(kTaken, rig.status() & (kTaken | kTargetReached));
    if (!bit_stays) rig.control(0x0F);
    rig.step(1500);
    TEST_ASSERT_EQUAL_INT64(400000 * kCount, rig.servo.setpoint());
    TEST_ASSERT_EQUAL_UINT32(0x0308, rig.get(0x0012));
    TEST_ASSERT_EQUAL_UINT32(0x0138, rig.get(0x0013));
    TEST_ASSERT_EQUAL_UINT32(kTargetReached, rig.status() & (kTaken | kTargetReached));
  }
}

TEST_F(Enabled402, a_kept_set_point_that_another_mode_drops_leaves_a_reason) {
  start_move(400000);
  control(0x0F);
  start_move(800000);
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(kTaken, status() & kTaken);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 6));
  step(1500);
  TEST_ASSERT_EQUAL_UINT32(6, get(0x0043));
  TEST_ASSERT_EQUAL_INT64(400000 * kCount, servo.setpoint());
  expect_refused(0x8201, 0x0042);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  step(5);
  start_move(800000);
  control(0x0F);
  step(1500);
  TEST_ASSERT_EQUAL_INT64(800000 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0012));
}

TEST_F(Velocity, bit_4_means_nothing_there_and_is_no_set_point_that_a_mode_drops) {
  control(0x1F);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  step(5);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0043));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0012));
}

}  // namespace
