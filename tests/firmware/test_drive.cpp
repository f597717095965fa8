// SPDX-License-Identifier: Apache-2.0
// CiA 402 as a client sees it, through Modbus: the states.
#include "tests/firmware/drive402.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

TEST_F(Drive402, the_drive_comes_up_switch_on_disabled) { TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x004F); }

TEST_F(Drive402, an_unconfigured_axis_stays_not_ready) {
  static Axis<64> bare;
  static firmware::Application other;
  other.begin(bare, {&servo, &line, &dog});
  other.poll();
  TEST_ASSERT_EQUAL_ENUM(firmware::DriveState::kNotReady, other.drive().state());
}

TEST_F(Drive402, commands_that_mean_nothing_in_a_state_are_ignored) {
  for (const uint32_t word : {0x07U, 0x0FU, 0x00U, 0x02U, 0x80U, 0x1FU}) {
    TEST_INFO("controlword", word);
    control(word);
    TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x004F);
  }
  control(0x06);
  TEST_ASSERT_EQUAL_UINT32(0x0021, state());
  control(0x06);
  TEST_ASSERT_EQUAL_UINT32(0x0021, state());
  TEST_ASSERT_FALSE(servo.enabled());
}

TEST_F(Drive402, switch_on_and_enable_may_come_in_one_word) {
  control(0x06);
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0x0027, state());
}

TEST_F(Drive402, every_way_down_takes_the_output_away) {
  struct Row {
    uint32_t word;
    uint32_t state;
  };
  constexpr Row kRows[] = {{0x07, 0x23}, {0x06, 0x21}, {0x00, 0x40}, {0x02, 0x40}};
  for (const Row& row : kRows) {
    TEST_INFO("controlword", row.word);
    control(0x00);
    enable();
    TEST_ASSERT_TRUE(servo.enabled());
    control(row.word);
    TEST_ASSERT_EQUAL_UINT32(row.state, status() & (row.state == 0x40 ? 0x4FU : 0x6FU));
    TEST_ASSERT_FALSE(servo.enabled());
  }
}

TEST_F(Drive402, enabling_starts_at_the_actual_position) {
  servo.position = -777 * kCount;
  step(2);
  enable();
  TEST_ASSERT_EQUAL_INT64(-777 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_INT32(-777, get_wide(0x0046));
  TEST_ASSERT_EQUAL_INT32(-777, get_wide(0x0048));
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
}

TEST_F(Drive402, without_feedback_enabling_waits_and_says_why) {
  servo.valid = false;
  step(2);
  control(0x06);
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0x0023, state());
  TEST_ASSERT_EQUAL_UINT32(0x8300, get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0011));
  servo.valid = true;
  step(2);
  TEST_ASSERT_EQUAL_UINT32(0x0027, state());
}

TEST_F(Drive402, a_set_point_bit_that_is_up_when_enabling_starts_nothing) {
  control(0x06);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, 5000));
  control(0x1F);
  TEST_ASSERT_EQUAL_UINT32(0x0027, state());
  step(200);
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
}

// Watched at every tick: 12 rises with 10 falling; 12 falls after 4 falls; 10 rises only after the setpoint has stood
// for the position window's time.

TEST_F(Enabled402, quick_stop_ramps_and_ends_switch_on_disabled) {
  start_move(1700000);
  control(0x0F);
  step(500);
  const size_t before = servo.commands.size();
  Bytes quick_stop = framed({1, 6, 0, 0x40, 0, 0x02});
  send(quick_stop);
  bool seen_active = false;
  for (int i = 0; i < 200; ++i) {
    step();
    seen_active = seen_active || (drive.drive().statusword() & 0x6F) == 0x07;
  }
  answer();
  TEST_ASSERT_TRUE(seen_active);
  TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x004F);
  TEST_ASSERT_FALSE(servo.enabled());
  // 1.2e6 counts/s at 1e8 counts/s^2 and 1e11 counts/s^3: 12 ms and a jerk ramp of 1 ms; Modbus takes some before.
  size_t last_change = 0;
  for (size_t i = before; i < servo.commands.size(); ++i) {
    if (servo.commands[i].setpoint == servo.commands[i - 1].setpoint) continue;
    last_change = i;
    TEST_ASSERT_TRUE(servo.commands[i].enabled);
  }
  TEST_ASSERT_AT_MOST_INT64(30, static_cast<int64_t>(last_change - before));
  enable();
  start_move(0);
  control(0x0F);
  step(3000);
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());
}

TEST_F(Enabled402, halt_stands_stays_enabled_and_forgets_the_move) {
  start_move(1700000);
  control(0x0F);
  step(500);
  const size_t before = servo.commands.size();
  control(0x10F);
  step(120);
  const auto velocity = [&](size_t i) { return servo.commands[i].setpoint - servo.commands[i - 1].setpoint; };
  for (size_t i = before; i < servo.commands.size(); ++i) {
    TEST_ASSERT_AT_MOST_INT64(20 * kCount + 2, velocity(i - 1) - velocity(i));  // the profile's 2e7 counts/s^2
  }
  const int64_t stood = servo.setpoint();
  TEST_ASSERT_EQUAL_UINT32(0x0027 | kTargetReached, status() & (0x006F | kTargetReached));
  control(0x11F);  // no set-point while halted
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
  TEST_ASSERT_EQUAL_UINT32(0x8200, get(0x0012));
  control(0x0F);
  step(100);
  TEST_ASSERT_EQUAL_INT64(stood, servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(0, status() & kTargetReached);  // it is not where it was sent
  control(0x1F);
  control(0x0F);
  step(3000);
  TEST_ASSERT_EQUAL_INT64(1700000 * kCount, servo.setpoint());
}

TEST_F(Enabled402, disable_voltage_takes_the_output_away_while_moving) {
  start_move(1700000);
  control(0x0F);
  step(500);
  send(framed({1, 6, 0, 0x40, 0, 0x00}));
  step(5);
  TEST_ASSERT_FALSE(servo.enabled());
  step(20);
  answer();
  TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x004F);
}

TEST_F(Enabled402, disable_operation_ramps_first) {
  start_move(1700000);
  control(0x0F);
  step(500);
  const size_t before = servo.commands.size();
  control(0x07);
  step(120);
  TEST_ASSERT_EQUAL_UINT32(0x0023, state());
  TEST_ASSERT_FALSE(servo.enabled());
  const auto velocity = [&](size_t i) { return servo.commands[i].setpoint - servo.commands[i - 1].setpoint; };
  for (size_t i = before; i < servo.commands.size(); ++i) {
    TEST_ASSERT_AT_MOST_INT64(20 * kCount + 2, velocity(i - 1) - velocity(i));  // the profile's 2e7 counts/s^2
    if (velocity(i) != 0) TEST_ASSERT_TRUE(servo.commands[i].enabled);
  }
}

TEST_F(Enabled402, enabling_again_at_once_starts_from_the_actual_position_and_at_rest) {
  start_move(1700000);
  control(0x0F);
  step(500);
  // Three words without a tick between them: the drive must not go on as if it had never been off.
  for (const uint8_t word : Bytes{0x00, 0x06, 0x0F}) {
    send(framed({1, 6, 0, 0x40, 0, word}));
    step_silent(10);
    answer();
  }
  const size_t before = servo.commands.size();
  step(200);
  bool was_off = false;
  for (size_t i = before; i < servo.commands.size(); ++i) was_off = was_off || !servo.commands[i].enabled;
  TEST_ASSERT_TRUE(was_off);
  TEST_ASSERT_EQUAL_UINT32(0x0027, state());
  const int64_t stands = servo.setpoint();
  step(100);
  TEST_ASSERT_EQUAL_INT64(stands, servo.setpoint());
}

// The same, with no tick and no timer at all between the words.

TEST_F(Rig, a_drive_that_never_saw_itself_off_does_not_go_on_as_enabled) {
  enable();
  firmware::ControlLoop loop;
  firmware::Drive state_machine;
  firmware::Parameters parameters;
  Servo other_servo;
  axis.reset(0);
  parameters.load_defaults();
  loop.begin(axis, other_servo);
  firmware::PositionStream stream;
  state_machine.begin(axis, loop, parameters, stream);
  const auto tick = [&] {
    loop.tick();
    state_machine.service();
  };
  tick();
  tick();
  for (const uint16_t word : {uint16_t{0x06}, uint16_t{0x0F}}) state_machine.write_controlword(word);
  for (int i = 0; i < 5; ++i) tick();
  TEST_ASSERT_EQUAL_ENUM(firmware::DriveState::kOperationEnabled, state_machine.state());
  for (const uint16_t word : {uint16_t{0x00}, uint16_t{0x06}, uint16_t{0x07}, uint16_t{0x0F}}) {
    state_machine.write_controlword(word);
  }
  state_machine.service();
  state_machine.service();
  TEST_ASSERT_EQUAL_ENUM(firmware::DriveState::kSwitchedOn, state_machine.state());
  for (int i = 0; i < 5; ++i) tick();
  TEST_ASSERT_EQUAL_ENUM(firmware::DriveState::kOperationEnabled, state_machine.state());
  uint32_t off = 0;
  for (size_t i = 5; i < other_servo.commands.size(); ++i) off += other_servo.commands[i].enabled ? 0U : 1U;
  TEST_ASSERT_AT_LEAST_INT64(1, off);
}

TEST_F(Enabled402, a_fault_shows_its_reaction_its_code_and_is_reset_by_a_rising_edge) {
  start_move(1700000);
  control(0x0F);
  step(500);
  servo.valid = false;
  step(3);
  servo.valid = true;
  TEST_ASSERT_EQUAL_UINT32(0x000F, drive.drive().statusword() & 0x004F);
  step(60);
  TEST_ASSERT_EQUAL_UINT32(0x0008, status() & 0x004F);
  TEST_ASSERT_EQUAL_UINT32(0x7300, get(0x0010));
  for (const uint32_t word : {0x00U, 0x06U, 0x07U, 0x0FU, 0x02U}) {
    control(word);
    TEST_ASSERT_EQUAL_UINT32(0x0008, status() & 0x004F);
  }
  control(0x80);
  TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x004F);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
  enable();
  servo.valid = false;
  step(3);
  servo.valid = true;
  step(10);
  TEST_ASSERT_EQUAL_UINT32(0x0008, status() & 0x004F);
  control(0x80);
  TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x004F);
  enable();
  control(0x8F);  // the bit rises without a fault: nothing to reset
  servo.valid = false;
  step(3);
  servo.valid = true;
  step(10);
  control(0x8F);  // still up: no edge
  TEST_ASSERT_EQUAL_UINT32(0x0008, status() & 0x004F);
  control(0x0F);
  control(0x8F);
  TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x004F);
}

TEST_F(Enabled402, a_silent_link_faults_and_the_ramp_goes_on_when_it_comes_back) {
  start_move(1700000);
  control(0x0F);
  step(500);
  step_silent(98);
  TEST_ASSERT_EQUAL_UINT32(0x0027, drive.drive().statusword() & 0x006F);
  step_silent(2);
  TEST_ASSERT_EQUAL_UINT32(0x000F, drive.drive().statusword() & 0x004F);
  const size_t before = servo.commands.size();
  step(60);
  TEST_ASSERT_EQUAL_UINT32(0x0008, status() & 0x004F);
  TEST_ASSERT_EQUAL_UINT32(0x8130, get(0x0010));
  TEST_ASSERT_EQUAL_UINT32(1, get_wide(0x001C));
  for (size_t i = before; i < servo.commands.size(); ++i) {
    if (servo.commands[i].setpoint != servo.commands[i - 1].setpoint) TEST_ASSERT_TRUE(servo.commands[i].enabled);
  }
}

TEST_F(Enabled402, the_axis_limits_cannot_change_while_it_moves) {
  unlock();
  start_move(1700000);
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(6, write_wide(0x0058, 5000000));
  TEST_ASSERT_EQUAL_UINT32(0x8100, get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0x0058, get(0x0013));
  TEST_ASSERT_EQUAL_UINT32(10000000, get_wide(0x0058));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 1e7, axis.config().maximum.velocity);
}

TEST_F(Enabled402, actual_velocity_and_following_error_are_of_the_same_tick) {
  start_move(1700000);
  control(0x0F);
  step(700);  // cruising at 1.2e6 counts/s
  const std::vector<uint16_t> words = read(0x0046, 10);
  const auto wide = [&](size_t at) { return static_cast<int32_t>((uint32_t{words[at]} << 16) | words[at + 1]); };
  TEST_ASSERT_DOUBLE_WITHIN(2.0, 1200000.0, wide(8));
  TEST_ASSERT_EQUAL_INT32(0, wide(6));
  TEST_ASSERT_EQUAL_INT32(wide(0), wide(4));
}

}  // namespace
