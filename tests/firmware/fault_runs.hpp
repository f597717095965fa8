// SPDX-License-Identifier: Apache-2.0
// One fault, provoked at a random moment of a random move, and what has to become of it: within its bound the drive
// stands or is off, by setpoints within the limits of the stop; it says why; and it moves again after a reset.
#pragma once

#include <cmath>

#include "tests/firmware/faulty_drive.hpp"

namespace stillpoint::testing {

// The drive is enabled, and is so again after it.
class FaultRun {
 public:
  FaultRun(FaultyDrive& drive, Random& random, const Provocation& provoked)
      : drive_(drive), servo_(drive.servo), cause_(provoked.cause), fault_(provoked.fault), random_(random) {
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
    TEST_INFO("cause", static_cast<int>(cause_));
    TEST_INFO("option", option_);
    TEST_INFO("moment", moment);
    TEST_INFO("shaped", shaped_);
    go_on_until(moment);
    moved_ = servo_.commands.back().setpoint != servo_.commands[servo_.commands.size() - 2].setpoint;
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
  static constexpr uint32_t kClientMs = 100;
  static constexpr int32_t kLimit = 1 << 22;  // counts, either way

  static std::vector<uint16_t> words(std::initializer_list<uint32_t> values) {
    std::vector<uint16_t> all;
    for (const uint32_t value : values) {
      all.push_back(static_cast<uint16_t>(value >> 16));
      all.push_back(static_cast<uint16_t>(value));
    }
    return all;
  }

  void set_up() {
    drive_.unlock();
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write_wide(0x006C, 20000));
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write_single(0x006E, 5));
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write(0x0074, {0xFFC0, 0, 0x0040, 0}));  // -+ kLimit
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write_single(0x0079, option_));
    shaped_ = random_.integer(0, 1) != 0;
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write(0x0102, {0x0001, 0xADB0, 11000, 0, 1, 0}));  // ZV, 11 Hz, 0.11
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write_single(0x0100, shaped_));
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write_single(0x0130, 1));
    for (int i = 0; i < 20 && drive_.get(0x0131) != shaped_; ++i) drive_.step(20);
    TEST_ASSERT_EQUAL_UINT32(shaped_, drive_.get(0x0131));
  }

  void move() {
    const auto velocity = static_cast<uint32_t>(velocity_);
    const auto acceleration = static_cast<uint32_t>(acceleration_);
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write(0x0060, words({velocity, acceleration, acceleration})));
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write_wide(0x0068, static_cast<int64_t>(jerk_ / 1e3)));
    counted_ = times_in_history();
    if (cause_ == Cause::kClientGone) {
      drive_.unlock();
      TEST_ASSERT_EQUAL_UINT32(0, drive_.write_single(0x0023, kClientMs));
    }
    drive_.start_move(static_cast<int32_t>(random_.integer(-4000000, 4000000)));
  }

  // With a client that is heard of as long as it is watched.
  void go_on_until(uint32_t moment) {
    const size_t end = servo_.commands.size() + moment;
    while (servo_.commands.size() < end) {
      if (cause_ == Cause::kClientGone) static_cast<void>(drive_.status());
      const size_t left = end > servo_.commands.size() ? end - servo_.commands.size() : 0;
      drive_.step(static_cast<uint32_t>(left < 20 ? left : 20));
    }
  }

  // What the fault is provoked by; it is raised in the last tick of it, or a few later.
  void provoke() {
    before_ = servo_.commands.size();
    switch (cause_) {
      case Cause::kInvalid: return lose_feedback(servo_.valid);
      case Cause::kStale: return lose_feedback(servo_.count_up);
      case Cause::kLost: return drop_frames(static_cast<uint32_t>(random_.integer(3, 90)));
      case Cause::kDamaged: return drive_.damage_frames(static_cast<uint32_t>(random_.integer(3, 20))), drive_.step(4);
      case Cause::kSilence: return drive_.stay_silent(static_cast<uint32_t>(random_.integer(101, 500)));
      case Cause::kLagging:
        servo_.encoder_off = servo_.position < 0 ? 100000 * kCount : -100000 * kCount;
        return drop_frames(1);  // the jump itself is not seen
      case Cause::kBeyond:
        TEST_ASSERT_EQUAL_UINT32(0, drive_.write_wide(0x006C, 0));
        before_ = servo_.commands.size();
        servo_.encoder_off = ((servo_.position < 0 ? -1 : 1) * int64_t{2 * kLimit}) * kCount - servo_.position;
        return drop_frames(1);
      case Cause::kJump: servo_.encoder_off = 50000000 * kCount; return drive_.step();
      case Cause::kClientGone: return;
      default: drive_.note(fault_);
    }
  }

  void lose_feedback(bool& healthy) {
    healthy = false;
    drive_.step(4);
    healthy = true;
  }

  void drop_frames(uint32_t count) {
    servo_.sequence = static_cast<uint16_t>(servo_.sequence + count);
    drive_.step(7);
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
    // What is only known by its time.
    const uint32_t notice = cause_ == Cause::kClientGone ? drive_.ticks_in(kClientMs + 10) : 0;
    const uint32_t most = bound() + drive_.lag() + notice + (cause_ == Cause::kSilence ? 1 : 0);
    TEST_INFO("bound", most);
    // On the host to the end of it; a tick of the chip's takes longer.
    const bool whole = drive_.lag() == 0;
    for (uint32_t i = 0; i < most && (whole || servo_.enabled() || i < 2); ++i) drive_.step();
    TEST_ASSERT_FALSE(servo_.enabled());
    // The stop's limits, or the move's where it was beyond them, on each setpoint under torque.
    const double tick3 = 1e-9;
    const double jerk = (jerk_ > kQuickJerk ? jerk_ : kQuickJerk) * tick3 * 4294967296.0 + 8.0;
    const double change =
        (acceleration_ > kQuickDeceleration ? acceleration_ : kQuickDeceleration) * 1e-6 * 4294967296.0 + 4.0;
    const std::vector<hal::ServoCommand>& stream = servo_.commands;
    size_t i = before_ < 3 ? 3 : before_;
    for (; i < stream.size() && stream[i].enabled; ++i) {
      const auto step_at = [&](size_t k) { return static_cast<double>(stream[k].setpoint - stream[k - 1].setpoint); };
      const double d2 = step_at(i) - step_at(i - 1);
      TEST_INFO("tick", i - before_);
      TEST_ASSERT_AT_MOST_DOUBLE(change, std::fabs(d2));
      TEST_ASSERT_AT_MOST_DOUBLE(jerk, std::fabs(d2 - (step_at(i - 1) - step_at(i - 2))));
    }
    for (; i < stream.size(); ++i) TEST_ASSERT_FALSE(stream[i].enabled);
  }

  // As the history counts it: the newest entry of that code says, of as many as one request tells.
  uint32_t times_in_history() {
    constexpr size_t kWords = 16;
    constexpr size_t kEntries = 7;
    const std::vector<uint16_t> history = drive_.read(0x0500, kEntries * kWords);
    newest_[0] = history[0];
    newest_[1] = history[1];
    for (size_t at = 0; at < history.size(); at += kWords) {
      if (history[at] == static_cast<uint32_t>(fault_)) return history[at + 1];
    }
    return 0;
  }

  void check_the_cause() {
    TEST_ASSERT_EQUAL_UINT32(static_cast<uint32_t>(fault_), drive_.get(0x0010));
    TEST_ASSERT_EQUAL_UINT32(0x0008, drive_.status() & 0x004F);
    const std::vector<uint16_t> history = drive_.read(0x0500, 18);
    TEST_ASSERT_EQUAL_UINT32(static_cast<uint32_t>(fault_), history[0]);
    TEST_ASSERT_EQUAL_UINT32(counted_ + 1, history[1]);
    TEST_ASSERT_EQUAL_UINT32(newest_[0], history[16]);
    TEST_ASSERT_EQUAL_UINT32(newest_[1], history[17]);
  }

  // A position limit's from where it is, by an encoder that was right; the others' from 0.
  void recover() {
    const bool outside = cause_ == Cause::kBeyond;
    const int32_t side = servo_.position + servo_.encoder_off < 0 ? -1 : 1;
    const int32_t target = outside ? side * kLimit : 12345;
    servo_.encoder_off = 0;
    servo_.position = outside ? target * kCount + side * int64_t{12345} * kCount : 0;
    drive_.step(2);
    drive_.unlock();
    TEST_ASSERT_EQUAL_UINT32(0, drive_.write_single(0x0023, 0));
    drive_.control(0x00);
    drive_.control(0x80);
    TEST_ASSERT_EQUAL_UINT32(0, drive_.get(0x0010));
    TEST_ASSERT_EQUAL_UINT32(0x0040, drive_.state() & 0x004F);
    drive_.enable();
    drive_.step(outside ? 50 : 0);
    drive_.start_move(target);
    drive_.control(0x0F);
    for (uint32_t i = 0; i < 3000 && servo_.setpoint() != target * kCount; ++i) drive_.step();
    TEST_ASSERT_EQUAL_INT64(target * kCount, servo_.setpoint());
    TEST_ASSERT_EQUAL_UINT32(0, drive_.get(0x0010));
  }

  FaultyDrive& drive_;
  Servo& servo_;
  Cause cause_;
  firmware::FaultCode fault_;
  Random& random_;
  uint16_t option_ = 0;
  double velocity_ = 0.0;
  double acceleration_ = 0.0;
  double jerk_ = 0.0;
  bool shaped_ = false;
  bool moved_ = false;
  size_t before_ = 0;
  uint16_t newest_[2] = {};  // in the history, before
  uint32_t counted_ = 0;
};

}  // namespace stillpoint::testing
