// SPDX-License-Identifier: Apache-2.0
// Profile velocity, homing, and the change from one mode to another.
#include "tests/firmware/modes402.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::testing;

TEST_F(Velocity, what_is_written_is_followed_within_the_profiles_limits_and_reached_is_said) {
  TEST_ASSERT_EQUAL_UINT32(kBit12, status() & kBit12);
  velocity(500000);
  TEST_ASSERT_EQUAL_UINT32(0, status() & (kBit12 | kTargetReached));
  step(200);
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, 500000.0, speed());
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & (kBit12 | kTargetReached));
  velocity(-1200000);
  step(3);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTargetReached);
  step(400);
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, -1200000.0, speed());
  velocity(0);
  step(200);
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, speed());
  TEST_ASSERT_EQUAL_UINT32(kBit12 | kTargetReached, status() & (kBit12 | kTargetReached));
  within_limits();
}

TEST_F(Velocity, a_faster_one_than_the_profile_is_refused_naming_it_and_what_runs_goes_on) {
  velocity(-300000);
  step(200);
  velocity(-1200001);
  step(50);
  TEST_ASSERT_EQUAL_UINT32(0x0052, get(0x0013));
  TEST_ASSERT_EQUAL_INT32(-1200000, get_wide(0x0016));
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, -300000.0, speed());
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0060, 2000000));
  velocity(-1200001);
  step(200);
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, -1200001.0, speed());
}

TEST_F(Velocity, halt_slows_to_zero_and_goes_on_after) {
  velocity(400000);
  step(100);
  control(0x10F);
  step(100);
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, speed());
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & kTargetReached);
  TEST_ASSERT_EQUAL_INT32(400000, get_wide(0x0052));
  control(0x0F);
  step(100);
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, 400000.0, speed());
  within_limits();
}

TEST_F(Velocity, neither_enabling_nor_the_mode_starts_a_motion) {
  velocity(400000);
  step(100);
  control(0x07);
  step(200);
  TEST_ASSERT_FALSE(servo.enabled());
  velocity(400000);  // while it is off
  control(0x0F);
  step(200);
  TEST_ASSERT_TRUE(servo.enabled());
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, speed());
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x0052));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  velocity(300000);
  step(100);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 3));
  step(100);
  TEST_ASSERT_EQUAL_UINT32(3, get(0x0043));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, speed());
  control(0x1F);  // no set-points here
  step(100);
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, speed());
}

TEST_F(Velocity, the_mode_changes_once_the_axis_stands) {
  velocity(400000);
  step(100);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  step(10);
  TEST_ASSERT_EQUAL_UINT32(3, get(0x0043));
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, 400000.0, speed());
  velocity(0);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0043));
  start_move(1000);
  control(0x0F);
  step(2000);
  TEST_ASSERT_EQUAL_INT64(1000 * kCount, servo.setpoint());
}

TEST_F(Velocity, a_fault_and_a_quick_stop_forget_the_velocity) {
  for (const bool fault : std::initializer_list<bool>{false, true}) {
    TEST_INFO("fault", fault);
    velocity(400000);
    step(100);
    if (fault) drive.note_fault(firmware::FaultCode::kStackOverflow);
    control(fault ? 0x0F : 0x02);
    step(100);
    TEST_ASSERT_FALSE(servo.enabled());
    control(0x80);
    enable();
    step(200);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, speed());
  }
}

TEST_F(Homing, where_it_stands_becomes_zero_without_motion) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  step(2);
  start_move(123456);
  control(0x0F);
  step(1500);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 6));
  step(2);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kBit12);
  const size_t before = servo.commands.size();
  control(0x1F);
  step(10);
  for (size_t i = before; i < servo.commands.size(); ++i) {
    TEST_ASSERT_EQUAL_INT64(123456 * kCount, servo.commands[i].setpoint);
    TEST_ASSERT_TRUE(servo.commands[i].enabled);
  }
  TEST_ASSERT_EQUAL_UINT32(kBit12 | kTargetReached, status() & (kBit12 | kBit13 | kTargetReached));
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x0046));
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x0048));
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x004A));
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x004C));
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x004E));
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  step(2);
  start_move(1000);
  control(0x0F);
  step(1500);
  TEST_ASSERT_EQUAL_INT64(124456 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_INT32(1000, get_wide(0x0046));
}

TEST_F(Homing, home_outlasts_switching_off_and_the_motor_being_turned_by_hand) {
  servo.position = 0;
  control(0x1F);
  step(10);
  control(0x0F);
  control(0x00);
  step(5);
  servo.position = 5000 * kCount;
  step(5);
  enable();
  TEST_ASSERT_EQUAL_INT32(5000, get_wide(0x0046));
  control(0x1F);
  step(10);
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x0046));
  control(0x0F);
  control(0x00);
  step(5);
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x0046));
  servo.position = 4000 * kCount;
  step(5);
  TEST_ASSERT_EQUAL_INT32(-1000, get_wide(0x0046));
}

TEST_F(Homing, wants_the_bit_to_rise_the_drive_enabled_and_the_axis_at_rest) {
  servo.position = 0;
  control(0x00);
  step(5);
  servo.position = 700 * kCount;
  step(2);
  control(0x06);
  control(0x17);
  step(10);
  TEST_ASSERT_EQUAL_INT32(700, get_wide(0x0046));
  control(0x1F);  // enables; the bit was up before
  step(10);
  TEST_ASSERT_EQUAL_INT32(700, get_wide(0x0046));
  TEST_ASSERT_EQUAL_UINT32(0, status() & kBit12);
  control(0x10F);
  control(0x11F);
  TEST_ASSERT_EQUAL_UINT32(0x8200, get(0x0012));
  TEST_ASSERT_EQUAL_INT32(700, get_wide(0x0046));
}

TEST_F(Streamed, positions_are_followed_smoothly_to_where_they_end) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0088, 50));
  TEST_ASSERT_EQUAL_UINT32(0, send_positions(swings(0, 32)));
  TEST_ASSERT_EQUAL_UINT32(32, get(0x008A));
  TEST_ASSERT_EQUAL_UINT32(96, get(0x008B));
  step(100);
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());  // nothing moves before bit 4
  const size_t begun = servo.commands.size();
  control(0x1F);
  step(20);
  TEST_ASSERT_EQUAL_UINT32(kBit12, status() & kBit12);
  TEST_ASSERT_EQUAL_UINT32(0, send_positions(swings(32, 31)));
  step(4000);
  TEST_ASSERT_EQUAL_INT64(swing(62) * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x008C));
  TEST_ASSERT_EQUAL_UINT32(1, get_wide(0x008E));
  // 50 ms from position to position: the acceleration stays near that of the swing, 10,000 counts (2 rad/s)^2.
  for (size_t i = begun + 2; i < servo.commands.size(); ++i) {
    const auto at = [&](size_t k) { return static_cast<double>(servo.commands[k].setpoint) / 4294967296.0; };
    TEST_ASSERT_AT_MOST_DOUBLE(0.06, std::fabs(at(i) - 2 * at(i - 1) + at(i - 2)));
  }
  control(0x0F);
  step(50);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kBit12);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 1));
  step(5);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0043));
}

TEST_F(Streamed, what_breaks_the_limits_is_kept_within_them_or_faults_as_0089_says) {
  for (const uint32_t policy : std::initializer_list<uint32_t>{0, 1}) {
    TEST_INFO("policy", policy);
    Streamed rig;
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0089, policy));
    TEST_ASSERT_EQUAL_UINT32(0, rig.send_positions({0, 0, 500000, 500000}));
    rig.control(0x1F);
    rig.step(1500);
    rig.within_limits();
    TEST_ASSERT_EQUAL_UINT32(policy == 0 ? 0 : 0xFF01, rig.get(0x0010));
    TEST_ASSERT_AT_LEAST_INT64(1, rig.get_wide(0x008C));
    if (policy == 0) TEST_ASSERT_EQUAL_INT64(500000 * kCount, rig.servo.setpoint());
    if (policy != 0) TEST_ASSERT_FALSE(rig.servo.enabled());
  }
}

TEST_F(Streamed, bit_4_falling_halt_and_faults_end_it_and_drop_what_waits) {
  for (const uint32_t word : std::initializer_list<uint32_t>{0x0F, 0x11F, 0x02}) {
    TEST_INFO("controlword", word);
    Streamed rig;
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0088, 50));
    TEST_ASSERT_EQUAL_UINT32(0, rig.send_positions(rig.swings(0, 32)));
    rig.control(0x1F);
    rig.step(700);
    rig.control(word);
    rig.step(200);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, rig.speed());
    TEST_ASSERT_EQUAL_UINT32(0, rig.get(0x008A));
    TEST_ASSERT_EQUAL_UINT32(0, rig.status() & kBit12);
    rig.step(500);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, rig.speed());
  }
}

TEST_F(Streamed, it_begins_where_the_axis_stands_or_not_at_all) {
  control(0x1F);
  step(5);
  TEST_ASSERT_EQUAL_UINT32(0x8601, get(0x0012));
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, send_positions({3, 4}));
  control(0x1F);
  step(50);
  TEST_ASSERT_EQUAL_UINT32(0x8601, get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0x0090, get(0x0013));
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());
}

TEST_F(Streamed, a_write_that_has_no_room_or_jumps_is_refused_whole) {
  for (int i = 0; i < 4; ++i) TEST_ASSERT_EQUAL_UINT32(0, send_positions(std::vector<int32_t>(31, 7)));
  TEST_ASSERT_EQUAL_UINT32(6, send_positions(std::vector<int32_t>(5, 7)));
  TEST_ASSERT_EQUAL_UINT32(0x8600, get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(4, get_wide(0x0016));
  TEST_ASSERT_EQUAL_UINT32(3, send_positions({7, 7 + (1 << 28) + 1}));
  TEST_ASSERT_EQUAL_UINT32(3, write(0x0090, {0, 7, 0}));
  TEST_ASSERT_EQUAL_UINT32(2, send_positions(std::vector<int32_t>(33, 7)));
  TEST_ASSERT_EQUAL_UINT32(2, write(0x0092, {0, 7}));
  TEST_ASSERT_EQUAL_UINT32(124, get(0x008A));
}

}  // namespace
