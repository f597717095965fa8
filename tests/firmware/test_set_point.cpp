// SPDX-License-Identifier: Apache-2.0
// The set-point handshake of profile position mode as a client sees it, through Modbus.
#include "tests/firmware/drive402.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

TEST_F(Enabled402, the_handshake_bits_come_in_order) {
  step(30);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & (kTargetReached | kTaken));
  start_move(20000);
  TEST_ASSERT_EQUAL_UINT32(kTaken, status() & (kTargetReached | kTaken));
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, status() & (kTargetReached | kTaken));
  int64_t last = servo.setpoint();
  uint32_t stood = 0;
  for (int tick = 0; (drive.drive().statusword() & kTargetReached) == 0; ++tick) {
    TEST_ASSERT_TRUE(tick < 2000);
    TEST_ASSERT_EQUAL_UINT32(0, drive.drive().statusword() & kTaken);
    step();
    stood = servo.setpoint() == last ? stood + 1 : 0;
    last = servo.setpoint();
  }
  TEST_ASSERT_EQUAL_INT64(20000 * kCount, servo.setpoint());
  TEST_ASSERT_AT_LEAST_INT64(19, stood);  // 20 ms, the first of them the arrival
  TEST_ASSERT_AT_MOST_INT64(22, stood);
}

TEST_F(Enabled402, target_reached_never_shows_between_taking_a_set_point_and_its_end) {
  servo.commit = false;  // the move stays planned and does not begin
  step(2);
  start_move(20000);
  for (int i = 0; i < 100; ++i) {
    step();
    TEST_ASSERT_EQUAL_UINT32(kTaken, drive.drive().statusword() & (kTargetReached | kTaken));
  }
  servo.commit = true;
  step(2);
  TEST_ASSERT_EQUAL_UINT32(kTaken, drive.drive().statusword() & (kTargetReached | kTaken));
}

TEST_F(Enabled402, target_reached_waits_for_the_position_to_come_into_its_window) {
  struct Lagging final : hal::ServoPort {
    Servo* servo;
    int64_t error = 0;
    void disable() override {}
    hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
      hal::ServoFeedback feedback = servo->exchange(command);
      feedback.position += error;
      return feedback;
    }
  } lagging;
  lagging.servo = &servo;
  static Axis<64> other_axis;
  static firmware::Application other;
  TEST_ASSERT_OK(other_axis.configure(firmware::kDefaultAxis));
  Line other_line;
  other.begin(other_axis, {&lagging, &other_line, &dog});
  const auto step_other = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      other.tick();
      other.poll();
    }
  };
  const auto control_other = [&](uint8_t word) {
    const Bytes frame = framed({1, 6, 0x00, 0x40, 0x00, word});
    other_line.to_drive.assign(frame.begin(), frame.end());
    step_other(10);
  };
  step_other(2);
  control_other(0x06);
  control_other(0x0F);
  lagging.error = 101 * kCount;  // the window is 100
  control_other(0x1F);
  step_other(200);
  TEST_ASSERT_EQUAL_UINT32(0, other.drive().statusword() & kTargetReached);
  lagging.error = 100 * kCount;
  step_other(19);
  TEST_ASSERT_EQUAL_UINT32(0, other.drive().statusword() & kTargetReached);
  step_other(3);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, other.drive().statusword() & kTargetReached);
}

TEST_F(Enabled402, a_relative_set_point_counts_from_where_the_axis_stands) {
  start_move(20000);
  control(0x0F);
  step(600);
  start_move(-5000, 0x5F);
  control(0x0F);
  step(600);
  TEST_ASSERT_EQUAL_INT64(15000 * kCount, servo.setpoint());
}

// Bit 12 stays up while one is kept, 10 stays down in between.
TEST_F(Enabled402, a_set_point_while_moving_is_kept_with_its_limits_until_the_axis_stands) {
  start_move(1000000);
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0060, 300000));
  start_move(400000);
  TEST_ASSERT_EQUAL_UINT32(kTaken, status() & kTaken);
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(kTaken, status() & kTaken);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0060, 1200000));
  bool stood = false;
  int64_t fastest_back = 0;
  for (int i = 0; i < 5000 && servo.setpoint() != 400000 * kCount; ++i) {
    step();
    const auto& all = servo.commands;
    const int64_t change = all[all.size() - 2].setpoint - all.back().setpoint;
    if (change > fastest_back) fastest_back = change;
    stood = stood || servo.setpoint() == 1000000 * kCount;
    TEST_ASSERT_EQUAL_UINT32(0, drive.drive().statusword() & kTargetReached);
  }
  TEST_ASSERT_TRUE(stood);
  TEST_ASSERT_AT_MOST_INT64(300 * kCount, fastest_back);  // 1.2e6 counts/s would be four times that
  TEST_ASSERT_AT_LEAST_INT64(295 * kCount, fastest_back);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  step(50);
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & kTargetReached);
}

TEST_F(Enabled402, behind_a_kept_set_point_another_is_refused_and_one_at_once_replaces_both) {
  start_move(1000000);
  control(0x0F);
  start_move(400000);
  control(0x0F);
  start_move(200000);
  TEST_ASSERT_EQUAL_UINT32(static_cast<uint32_t>(Error::kBusy), get(0x0012) >> 8);
  control(0x0F);
  start_move(-300000, 0x3F);
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  step(4000);
  TEST_ASSERT_EQUAL_INT64(-300000 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & kTargetReached);
}

TEST_F(Enabled402, halt_and_quick_stop_drop_the_kept_set_point) {
  for (const uint32_t word : std::initializer_list<uint32_t>{0x10F, 0x02}) {
    TEST_INFO("controlword", word);
    start_move(1000000);
    control(0x0F);
    start_move(400000);
    control(0x0F);
    control(word);
    step(300);
    TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
    const int64_t stands = servo.setpoint();
    if (word == 0x02) enable();
    control(0x0F);
    step(3000);
    TEST_ASSERT_EQUAL_INT64(stands, servo.setpoint());
    start_move(0);
    control(0x0F);
    step(3000);
  }
}

// Two relative ones in a row go as far as both together.
TEST_F(Enabled402, a_kept_relative_set_point_counts_from_the_target_in_force) {
  start_move(100000, 0x5F);
  control(0x0F);
  start_move(100000, 0x5F);
  control(0x0F);
  step(4000);
  TEST_ASSERT_EQUAL_INT64(200000 * kCount, servo.setpoint());
}

TEST_F(Enabled402, a_relative_target_outside_the_range_is_refused_by_name) {
  start_move(10000);
  control(0x0F);
  step(600);
  start_move(INT32_MAX, 0x5F);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  const uint32_t reason = get(0x0012);
  TEST_ASSERT_EQUAL_ENUM(Error::kAboveMaximum, reason >> 8);
  TEST_ASSERT_EQUAL_ENUM(Quantity::kPosition, reason & 0xFF);
  TEST_ASSERT_EQUAL_UINT32(0x0044, get(0x0013));
  TEST_ASSERT_EQUAL_INT32(INT32_MAX, get_wide(0x0016));
  step(100);
  TEST_ASSERT_EQUAL_INT64(10000 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & kTargetReached);  // the old target still is
}

TEST_F(Enabled402, a_duration_that_the_limits_forbid_is_refused_with_the_least_one_and_that_is_taken) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0138, 100));
  start_move(1700000);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  TEST_ASSERT_EQUAL_ENUM(Quantity::kDuration, get(0x0012) & 0xFF);
  TEST_ASSERT_EQUAL_UINT32(0x0138, get(0x0013));
  const uint32_t least_ms = get_wide(0x0016);
  TEST_ASSERT_EQUAL_UINT32(1510, least_ms);  // Li's move, from the issue
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0138, least_ms));
  control(0x1F);
  TEST_ASSERT_EQUAL_UINT32(kTaken, status() & kTaken);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(1510, get_wide(0x013A));
}

TEST_F(Enabled402, lowering_the_bit_before_the_set_point_is_taken_withdraws_it) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, 5000));
  line.room = 0;  // the answer does not get out, so nothing is planned
  send(framed({1, 6, 0, 0x40, 0, 0x1F}));
  step(10);
  TEST_ASSERT_EQUAL_UINT32(0, drive.drive().statusword() & kTaken);
  line.room = SIZE_MAX;
  drive.own_timer_tick();
  send(framed({1, 6, 0, 0x40, 0, 0x0F}));
  // One poll sends the answer and plans; a client cannot be that fast, so only order matters here.
  step(10);
  TEST_ASSERT_EQUAL_UINT32(0, drive.drive().statusword() & kTaken);
}

TEST_F(Enabled402, a_set_point_bit_that_stays_up_or_is_written_again_starts_one_move) {
  start_move(20000);
  step(600);
  start_move(50000);
  step(600);
  TEST_ASSERT_EQUAL_INT64(20000 * kCount, servo.setpoint());
  control(0x0F);
  control(0x1F);
  step(600);
  TEST_ASSERT_EQUAL_INT64(50000 * kCount, servo.setpoint());
}

TEST_F(Enabled402, a_set_point_at_once_takes_over_in_flight) {
  start_move(1000000);
  control(0x0F);
  step(400);
  start_move(-200000, 0x3F);
  TEST_ASSERT_EQUAL_UINT32(kTaken, status() & (kTargetReached | kTaken));
  control(0x0F);
  step(3000);
  TEST_ASSERT_EQUAL_INT64(-200000 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(kTargetReached, status() & kTargetReached);
}

TEST_F(Enabled402, a_relative_set_point_in_flight_counts_from_the_target_in_force) {
  start_move(1000000);
  control(0x0F);
  step(400);
  start_move(500000, 0x7F);
  TEST_ASSERT_EQUAL_UINT32(kTaken, status() & kTaken);
  control(0x0F);
  step(4000);
  TEST_ASSERT_EQUAL_INT64(1500000 * kCount, servo.setpoint());
}

TEST_F(Enabled402, a_target_beyond_a_soft_limit_is_refused_with_the_limit) {
  TEST_ASSERT_EQUAL_UINT32(6, write_wide(0x0076, 300000));  // locked
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0074, {0xFFFF, 0xFFFF, 4, 0x93E0}));  // -1, 300000
  TEST_ASSERT_EQUAL_INT32(300000, axis.config().soft_high_counts);
  start_move(300001);
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  TEST_ASSERT_EQUAL_ENUM(Quantity::kPosition, get(0x0012) & 0xFF);
  TEST_ASSERT_EQUAL_UINT32(0x0044, get(0x0013));
  TEST_ASSERT_EQUAL_INT32(300000, get_wide(0x0016));
  control(0x0F);
  start_move(300000);
  control(0x0F);
  step(2000);
  TEST_ASSERT_EQUAL_INT64(300000 * kCount, servo.setpoint());
}

}  // namespace
