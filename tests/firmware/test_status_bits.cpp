// SPDX-License-Identifier: Apache-2.0
// What the modes' own bits of the statusword say: target reached, internal limit, following error.
#include "tests/firmware/modes402.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::testing;

constexpr uint32_t kLimit = 1U << 11;
constexpr uint32_t kBits = kTargetReached | kLimit | kBit12;

TEST_F(Enabled402, bit_13_is_the_following_error_once_its_time_is_over_until_it_is_reset) {
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x006C, 1000));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x006E, 200));
  servo.stuck = true;
  start_move(1000000);
  step(100);
  TEST_ASSERT_AT_LEAST_INT64(1001, static_cast<int32_t>(get_wide(0x004C)));
  TEST_ASSERT_EQUAL_UINT32(0, status() & kBit13);
  step(300);
  TEST_ASSERT_EQUAL_UINT32(0x8611, get(0x0010));
  TEST_ASSERT_EQUAL_UINT32(kBit13, status() & kBit13);
  control(0x80);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kBit13);
  enable();
  servo.stuck = false;
  drive.note_fault(firmware::FaultCode::kStackOverflow);
  step(20);
  TEST_ASSERT_EQUAL_UINT32(0x6101, get(0x0010));
  TEST_ASSERT_EQUAL_UINT32(0, status() & kBit13);
}

// In profile velocity the bit is reserved.
TEST_F(Velocity, bit_13_is_the_following_error_in_profile_position_only) {
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x006C, 1000));
  servo.stuck = true;
  velocity(400000);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0x8611, get(0x0010));
  TEST_ASSERT_EQUAL_UINT32(0, status() & kBit13);
}

TEST_F(Enabled402, in_a_quick_stop_that_stays_reached_is_that_it_stands) {
  for (const uint32_t mode : std::initializer_list<uint32_t>{1, 3}) {
    for (const uint32_t option : std::initializer_list<uint32_t>{5, 6}) {
      TEST_INFO("mode", mode);
      TEST_INFO("option", option);
      InMode rig(mode);
      rig.unlock();
      TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0078, option));
      TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0064, 4000000));
      if (mode == 3) rig.velocity(400000);
      if (mode == 1) rig.start_move(1700000);
      rig.step(300);
      rig.send(framed({1, 6, 0, 0x40, 0, 0x02}));
      rig.step(4);
      TEST_ASSERT_EQUAL_UINT32(0x0207, rig.drive.drive().statusword() & 0xEF6FU);
      bool moved = true;
      for (int i = 0; i < 400; ++i) {
        rig.step();
        const bool reached = (rig.drive.drive().statusword() & kTargetReached) != 0;
        if (rig.speed() != 0.0) TEST_ASSERT_FALSE(reached);
        moved = rig.speed() != 0.0;
      }
      TEST_ASSERT_FALSE(moved);
      rig.answer();
      TEST_ASSERT_EQUAL_UINT32(0x0617, rig.status() & 0xEFFF);
      rig.control(0x0F);
      TEST_ASSERT_EQUAL_UINT32(0x0027, rig.state());
    }
  }
}

TEST_F(Velocity, a_refused_one_is_not_reached_whatever_runs) {
  for (const int32_t runs : std::initializer_list<int32_t>{0, 500000}) {
    TEST_INFO("runs", runs);
    velocity(runs);
    step(300);
    TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & kTargetReached);
    velocity(2000000);
    step(300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, runs, speed());
    expect_refused(firmware::reason_of(Error::kAboveMaximum, Quantity::kVelocity), 0x0052);
    TEST_ASSERT_EQUAL_UINT32(0, status() & (kTargetReached | kLimit));
  }
  velocity(500000);
  step(100);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & kTargetReached);
}

// Behind a shaper too, which lets the setpoint have it later than the profile.
TEST_F(Velocity, reached_is_said_when_the_setpoint_has_the_velocity_and_not_before) {
  for (const bool shaped : std::initializer_list<bool>{false, true}) {
    TEST_INFO("shaped", shaped);
    if (shaped) {
      velocity(0);
      step(200);
      TEST_ASSERT_EQUAL_UINT32(0, write(0x0102, {0, 50000, 2000, 0, 2, 0, 0, 0}));
      TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 1));
      TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
      step(100);
      TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
      TEST_ASSERT_AT_LEAST_INT64(1, get_wide(0x0134));
    }
    for (const int32_t wanted : std::initializer_list<int32_t>{1, 333333, -1200000, -777, 1199999, 3}) {
      TEST_INFO("velocity", wanted);
      velocity(wanted);
      uint32_t reached = 0;
      for (int i = 0; i < 600; ++i) {
        step();
        const double off = std::fabs(speed() - wanted);
        const bool said = (drive.drive().statusword() & kTargetReached) != 0;
        if (off < 2e-5) TEST_ASSERT_TRUE(said);
        if (said) TEST_ASSERT_AT_MOST_DOUBLE(1e-3, off);
        reached += said ? 1U : 0U;
      }
      TEST_ASSERT_AT_LEAST_INT64(200, reached);
    }
  }
}

// Nothing is asked of the axis then, and nothing of the client.
TEST_F(Velocity, a_halt_at_rest_and_a_disabling_called_off_leave_it_reached_at_rest) {
  control(0x10F);
  step(50);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached | kBit12, status() & kBits);
  control(0x0F);
  step(50);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached | kBit12, status() & kBits);
  velocity(400000);
  step(100);
  send(framed({1, 6, 0, 0x40, 0, 0x07}));
  step(8);
  answer();
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0x0027, status() & (0x006F | kTargetReached | kBit12));
  step(100);
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, speed());
  TEST_ASSERT_EQUAL_UINT32(kTargetReached | kBit12, status() & kBits);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0012));
}

// Reached while the setpoint has the velocity asked for, and only then; then the limit, until something else is asked.
TEST_F(Velocity, a_soft_limit_that_holds_it_is_shown_and_not_called_reached) {
  control(0x00);
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0074, {0xFFFF, 0x0000, 0x0003, 0x0D40}));
  enable();
  velocity(100000);
  uint32_t reached = 0;
  for (int i = 0; i < 3000; ++i) {
    step();
    const uint32_t word = drive.drive().statusword();
    const bool at_speed = std::fabs(speed() - 100000.0) < 0.1;
    if ((word & kTargetReached) != 0) {
      TEST_ASSERT_TRUE(at_speed);
      ++reached;
    }
    if ((word & kLimit) != 0) TEST_ASSERT_EQUAL_INT64(200000 * kCount, servo.setpoint());
  }
  TEST_ASSERT_AT_LEAST_INT64(1500, reached);
  TEST_ASSERT_EQUAL_INT64(200000 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(kLimit | kBit12, status() & kBits);
  velocity(200000);  // refused there, and the limit's still
  step(50);
  expect_refused(firmware::reason_of(Error::kAboveMaximum, Quantity::kPosition), 0x0044);
  TEST_ASSERT_EQUAL_UINT32(kLimit | kBit12, status() & kBits);
  control(0x10F);  // a halt asks for no velocity
  step(50);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached | kBit12, status() & kBits);
  control(0x0F);
  step(50);
  TEST_ASSERT_EQUAL_UINT32(kLimit | kBit12, status() & kBits);
  velocity(-100000);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & kBits);
  velocity(0);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached | kBit12, status() & kBits);
}

}  // namespace
