// SPDX-License-Identifier: Apache-2.0
// How the drive stops: the options of a quick stop and of a fault, the client's watchdog, limiting against faulting.
#include "tests/firmware/drive402.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::testing;

struct Moving : Enabled402 {
  size_t begun = 0;

  void go(uint32_t ticks = 500) {
    start_move(1700000);
    control(0x0F);
    step(ticks);
    begun = servo.commands.size();
  }
  void option(uint32_t address, uint32_t value) {
    unlock();
    TEST_ASSERT_EQUAL_UINT32(0, write_single(address, value));
  }
  // Ticks from `begun` to the last change of the setpoint.
  int64_t ticks_to_stand() const {
    size_t last = begun;
    for (size_t i = begun; i < servo.commands.size(); ++i) {
      if (servo.commands[i].setpoint != servo.commands[i - 1].setpoint) last = i;
    }
    return static_cast<int64_t>(last - begun);
  }
};

// 1.2e6 counts/s: 12 ms at the quick stop's 1e8 counts/s^2, 60 ms at the profile's 2e7 and 93 with its jerk.
TEST_F(Moving, a_quick_stop_ramps_as_its_option_says) {
  struct Case {
    uint32_t option;
    uint32_t ends;  // state & 6F
    int64_t least;
    int64_t most;
  };
  constexpr Case kCases[] = {
      {0, 0x40, 0, 5}, {1, 0x40, 60, 130}, {2, 0x40, 5, 30}, {5, 0x07, 60, 130}, {6, 0x07, 5, 30}};
  for (const Case& c : kCases) {
    TEST_INFO("option", c.option);
    Moving rig;
    rig.option(0x0078, c.option);
    rig.go();
    rig.send(framed({1, 6, 0, 0x40, 0, 0x02}));
    rig.step(200);
    rig.answer();
    TEST_ASSERT_EQUAL_UINT32(c.ends, rig.state() & (c.ends == 0x40 ? 0x4F : 0x6F));
    TEST_ASSERT_EQUAL_INT32(c.ends == 0x07, rig.servo.enabled());
    TEST_ASSERT_AT_LEAST_INT64(c.least, rig.ticks_to_stand());
    TEST_ASSERT_AT_MOST_INT64(c.most, rig.ticks_to_stand());
  }
}

TEST_F(Moving, a_quick_stop_that_stays_goes_on_when_told_and_has_forgotten_the_move) {
  option(0x0078, 6);
  go();
  control(0x02);
  control(0x0F);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0x0027, state());
  const int64_t stands = servo.setpoint();
  step(100);
  TEST_ASSERT_EQUAL_INT64(stands, servo.setpoint());
  start_move(0);
  control(0x0F);
  step(3000);
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());
}

TEST_F(Moving, options_that_are_none_are_refused_by_name) {
  unlock();
  for (const uint32_t bad : std::initializer_list<uint32_t>{3, 4, 7, 0xFFFF}) {
    TEST_ASSERT_EQUAL_UINT32(3, write_single(0x0078, bad));
    TEST_ASSERT_EQUAL_UINT32(0x0078, get(0x0013));
  }
  TEST_ASSERT_EQUAL_UINT32(3, write_single(0x0079, 3));
  TEST_ASSERT_EQUAL_UINT32(2, get(0x0079));
}

TEST(a_fault_ramps_as_its_option_says) {
  struct Case {
    uint32_t option;
    int64_t least;
    int64_t most;
  };
  constexpr Case kCases[] = {{0, 0, 2}, {1, 60, 130}, {2, 5, 30}};
  for (const Case& c : kCases) {
    TEST_INFO("option", c.option);
    Moving rig;
    rig.option(0x0079, c.option);
    rig.go();
    rig.drive.note_fault(firmware::FaultCode::kStackOverflow);
    rig.step(200);
    TEST_ASSERT_EQUAL_UINT32(0x0008, rig.status() & 0x004F);
    TEST_ASSERT_FALSE(rig.servo.enabled());
    TEST_ASSERT_EQUAL_UINT32(0x6101, rig.get(0x0010));
    TEST_ASSERT_AT_LEAST_INT64(c.least, rig.ticks_to_stand());
    TEST_ASSERT_AT_MOST_INT64(c.most, rig.ticks_to_stand());
  }
}

// The ramp is the background's: where that is busy, the quick stop comes.
TEST_F(Moving, a_fault_that_waits_for_its_ramp_too_long_stops_quickly) {
  option(0x0079, 1);
  go();
  drive.note_fault(firmware::FaultCode::kStackOverflow);
  for (int i = 0; i < 100; ++i) drive.tick();
  TEST_ASSERT_FALSE(servo.enabled());
  TEST_ASSERT_AT_MOST_INT64(20 + 30, ticks_to_stand());
}

TEST_F(Moving, a_client_that_falls_silent_stops_the_axis_where_that_is_asked_for) {
  go();
  step(700);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
  option(0x0023, 100);
  start_move(0);
  for (int i = 0; i < 10; ++i) {
    step(50);
    TEST_ASSERT_EQUAL_UINT32(0x0027, state());
  }
  begun = servo.commands.size();
  step(160);
  TEST_ASSERT_EQUAL_UINT32(0x8100, get(0x0010));
  TEST_ASSERT_FALSE(servo.enabled());
  TEST_ASSERT_AT_MOST_INT64(140, ticks_to_stand());
}

// Function 8/4: from then on nothing is executed, so nothing could stop it.
TEST_F(Moving, an_axis_that_is_not_disabled_does_not_take_to_listening_only) {
  const auto refused = [&] {
    TEST_ASSERT_EQUAL_UINT32(6, exception_in(exchange({8, 0, 4, 0, 0})));
    expect_refused(0x8800, 0);
    TEST_ASSERT_TRUE(exchange_with(0, {8, 0, 4, 0, 0}).empty());
  };
  go(100);
  refused();
  control(0x02);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x4F);
  control(0x06);
  control(0x07);
  refused();
  control(0x00);
  TEST_ASSERT_TRUE(exchange({8, 0, 4, 0, 0}).empty());
  TEST_ASSERT_TRUE(exchange(read_request(0x0041, 1)).empty());
  TEST_ASSERT_TRUE(exchange({8, 0, 1, 0, 0}).empty());
  TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x4F);
}

// Only an enabled drive moves, so only there silence matters.
TEST_F(Drive402, a_silent_client_of_a_drive_that_is_off_is_none_of_its_business) {
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0023, 20));
  step(500);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
}

TEST_F(Moving, one_tick_that_overran_is_counted_and_two_in_a_row_are_a_fault) {
  go(100);
  drive.note_overrun();
  step(5);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
  TEST_ASSERT_EQUAL_UINT32(1, get_wide(0x001E));
  drive.note_overrun();
  step();
  drive.note_overrun();
  step(2);
  TEST_ASSERT_EQUAL_UINT32(0x6100, get(0x0010));
  TEST_ASSERT_EQUAL_UINT32(3, get_wide(0x001E));
}

TEST_F(Drive402, a_fault_noted_before_enabling_keeps_it_from_being_enabled) {
  drive.note_fault(firmware::FaultCode::kWatchdog);
  step(2);
  TEST_ASSERT_EQUAL_UINT32(0x0008, state() & 0x4F);
  control(0x06);
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0x0008, state() & 0x4F);
  TEST_ASSERT_EQUAL_UINT32(0x6010, get(0x0500));
  control(0x80);
  TEST_ASSERT_EQUAL_UINT32(0x0040, state() & 0x4F);
  enable();
}

TEST_F(Moving, a_motor_that_does_not_follow_is_a_fault_and_a_set_point_beyond_a_limit_only_a_refusal) {
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x006C, 1000));
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0074, {0, 0, 0x0010, 0}));  // 0 to 2^20
  start_move(1700000);
  TEST_ASSERT_EQUAL_UINT32(0x0044, get(0x0013));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
  control(0x0F);
  servo.stuck = true;
  start_move(1000000);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0x8611, get(0x0010));
  TEST_ASSERT_FALSE(servo.enabled());
}

}  // namespace
