// SPDX-License-Identifier: Apache-2.0
// One fault, provoked at a random moment of a random move, and what has to become of it: within its bound the drive
// stands or is off, by setpoints within the limits of the stop; it says why; and it moves again after a reset.
#pragma once

#include <cmath>

#include "tests/firmware/drive402.hpp"

namespace stillpoint::testing {

constexpr firmware::FaultCode kProvoked[] = {
    firmware::FaultCode::kFeedbackMissing,    firmware::FaultCode::kLinkSilent,
    firmware::FaultCode::kFollowingError,     firmware::FaultCode::kPositionLimit,
    firmware::FaultCode::kEncoderImplausible, firmware::FaultCode::kTickOverrun,
    firmware::FaultCode::kClientSilent,       firmware::FaultCode::kWatchdog,
    firmware::FaultCode::kStackOverflow,      firmware::FaultCode::kParametersBad,
};
constexpr size_t kProvokedCount = sizeof kProvoked / sizeof kProvoked[0];

class FaultRun : public Enabled402 {
 public:
  FaultRun(Random& random, firmware::FaultCode fault) : fault_(fault), random_(random) {
    constexpr uint16_t kOptions[] = {0, 1, 2};
    option_ = kOptions[random.integer(0, 2)];
    velocity_ = random.between(5e4, 5e6);
    acceleration_ = random.between(1e6, 1e8);
    jerk_ = std::floor(random.between(1e4, 1e7)) * 1e3;
  }

  void operator()() {
    set_up();
    move();
    const uint32_t moment = static_cast<uint32_t>(random_.integer(1, 1200));
    TEST_INFO("fault", static_cast<int>(fault_));
    TEST_INFO("option", option_);
    TEST_INFO("moment", moment);
    TEST_INFO("shaped", shaped_);
    step(moment);
    moved_ = servo.commands.back().setpoint != servo.commands[servo.commands.size() - 2].setpoint;
    provoke();
    watch_the_end();
    check_the_cause();
    recover();
  }

  // When the fault came.
  bool moved() const { return moved_; }

 private:
  static constexpr double kQuickDeceleration = 1e8;  // counts/s^2, as delivered
  static constexpr double kQuickJerk = 1e11;         // counts/s^3

  void set_up() {
    unlock();
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x006C, 20000));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x006E, 5));
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0074, {0xFFC0, 0, 0x0040, 0}));  // -+ 2^22
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0079, option_));
    shaped_ = random_.integer(0, 1) != 0;
    if (!shaped_) return;
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0102, {0x0001, 0xADB0, 11000, 0, 1, 0}));  // ZV, 11 Hz, 0.11
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 1));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    step(20);
  }

  void move() {
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0060, static_cast<int64_t>(velocity_)));
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0062, static_cast<int64_t>(acceleration_)));
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0064, static_cast<int64_t>(acceleration_)));
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0068, static_cast<int64_t>(jerk_ / 1e3)));
    if (fault_ == firmware::FaultCode::kClientSilent) {
      unlock();
      TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0023, 60));
    }
    start_move(static_cast<int32_t>(random_.integer(-4000000, 4000000)));
  }

  // What the fault is provoked by; it is raised in the last tick of it, or a few later.
  void provoke() {
    before_ = servo.commands.size();
    switch (fault_) {
      case firmware::FaultCode::kFeedbackMissing: return lose_feedback();
      case firmware::FaultCode::kLinkSilent: return step_silent(static_cast<uint32_t>(random_.integer(101, 900)));
      case firmware::FaultCode::kFollowingError:
        servo.encoder_off = servo.position < 0 ? 100000 * kCount : -100000 * kCount;
        servo.sequence = static_cast<uint16_t>(servo.sequence + 1);  // the jump itself is not seen
        return step(7);
      case firmware::FaultCode::kPositionLimit:
        TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x006C, 0));
        before_ = servo.commands.size();
        servo.encoder_off = ((servo.position < 0 ? -1 : 1) * int64_t{1 << 23}) * kCount - servo.position;
        servo.sequence = static_cast<uint16_t>(servo.sequence + 1);
        return step(7);
      case firmware::FaultCode::kEncoderImplausible: servo.encoder_off = 50000000 * kCount; return step();
      case firmware::FaultCode::kTickOverrun:
        for (int i = 0; i < 2; ++i) {
          step();
          drive.note_overrun();
        }
        return;
      case firmware::FaultCode::kClientSilent: return step(70);
      default: drive.note_fault(fault_); return step();
    }
  }

  void lose_feedback() {
    constexpr uint32_t kWays = 3;
    const int64_t way = random_.integer(0, kWays - 1);
    if (way == 0) servo.valid = false;
    if (way == 1) servo.count_up = false;
    if (way == 2) servo.sequence = static_cast<uint16_t>(servo.sequence + 3);
    step(4);
    servo.valid = true;
    servo.count_up = true;
  }

  // Ticks from a fault to the axis standing: of the ramp at its limits from full speed, and the shaper's length.
  uint32_t bound() const {
    const double a = option_ == 1 ? acceleration_ : kQuickDeceleration;
    const double j = option_ == 1 ? jerk_ : kQuickJerk;
    const double ramp = 1e3 * (velocity_ / a + 2.0 * a / j);
    const double by_jerk = 1e3 * 2.0 * std::sqrt(velocity_ / j);  // where a is not reached
    const double let_go = 1e3 * acceleration_ / j;                // what was in force comes off first
    const uint32_t shaper = option_ == 1 && shaped_ ? 60 : 0;
    return option_ == 0 ? 2 : static_cast<uint32_t>((ramp > by_jerk ? ramp : by_jerk) + let_go) + shaper + 30;
  }

  void watch_the_end() {
    step(fault_ == firmware::FaultCode::kLinkSilent ? 1 : 0);
    const uint32_t most = bound();
    TEST_INFO("bound", most);
    step(most);
    TEST_ASSERT_FALSE(servo.enabled());
    // The stop's limits, or the move's where it was beyond them, on each setpoint under torque.
    const double tick3 = 1e-9;
    const double jerk = (jerk_ > kQuickJerk ? jerk_ : kQuickJerk) * tick3 * 4294967296.0 + 8.0;
    const double change =
        (acceleration_ > kQuickDeceleration ? acceleration_ : kQuickDeceleration) * 1e-6 * 4294967296.0 + 4.0;
    const std::vector<hal::ServoCommand>& stream = servo.commands;
    for (size_t i = before_ < 3 ? 3 : before_; i < stream.size() && stream[i].enabled; ++i) {
      const auto step_at = [&](size_t k) { return static_cast<double>(stream[k].setpoint - stream[k - 1].setpoint); };
      const double d2 = step_at(i) - step_at(i - 1);
      TEST_INFO("tick", i - before_);
      TEST_ASSERT_AT_MOST_DOUBLE(change, std::fabs(d2));
      TEST_ASSERT_AT_MOST_DOUBLE(jerk, std::fabs(d2 - (step_at(i - 1) - step_at(i - 2))));
    }
  }

  void check_the_cause() {
    TEST_ASSERT_EQUAL_UINT32(static_cast<uint32_t>(fault_), get(0x0010));
    TEST_ASSERT_EQUAL_UINT32(0x0008, status() & 0x004F);
    TEST_ASSERT_EQUAL_UINT32(static_cast<uint32_t>(fault_), get(0x0500));
    TEST_ASSERT_EQUAL_UINT32(1, get(0x0501));
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0510));
  }

  void recover() {
    servo.encoder_off = 0;
    servo.position = 0;
    step(2);
    unlock();
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0023, 0));
    control(0x00);
    control(0x80);
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
    TEST_ASSERT_EQUAL_UINT32(0x0040, state() & 0x004F);
    enable();
    start_move(12345);
    control(0x0F);
    for (uint32_t i = 0; i < 3000 && servo.setpoint() != 12345 * kCount; ++i) step();
    TEST_ASSERT_EQUAL_INT64(12345 * kCount, servo.setpoint());
  }

  firmware::FaultCode fault_;
  Random& random_;
  uint16_t option_ = 0;
  double velocity_ = 0.0;
  double acceleration_ = 0.0;
  double jerk_ = 0.0;
  bool shaped_ = false;
  bool moved_ = false;
  size_t before_ = 0;
};

}  // namespace stillpoint::testing
