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

}  // namespace
