// SPDX-License-Identifier: Apache-2.0
// Who may have asked for what the servo link shows. It sits at the drive's two plugs and trusts nothing inside: the
// bytes that the drive took, with a CRC of its own; the first two bytes of what it answered; the commands to the servo.
//
// The statusword was not taken as the witness: a state machine that is wrong would then vouch for itself. A request
// counts once its normal answer is begun, so a frame that the drive was right to drop, to refuse, or that went to
// another unit or to all, never excuses a motion, whatever the drive thinks of it. Where the watch cannot tell what a
// request came to (a mask write of the controlword, limits changed on the way) it takes the most that it may have.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <vector>

#include "hal/servo_port.hpp"
#include "tests/fuzz/soft_limit_watch.hpp"
#include "tests/support/reference_crc.hpp"

namespace stillpoint::testing {

class ClientWatch {
 public:
  // Null, or what has been broken.
  const char* broken() const { return broken_; }

  // The drive has taken a byte, or found none.
  void read(bool any, uint8_t byte) {
    if (last_write_went_) answering_ = false;
    if (!any) return;
    if (bytes_.size() > kMostBytes) forget_bytes();
    if (bytes_.empty() || tick_ != byte_tick_) begins_.push_back(bytes_.size());
    byte_tick_ = tick_;
    heard_all_ = false;
    bytes_.push_back(byte);
  }

  // The drive has tried to send a byte. The line takes two of an answer at least.
  void written(bool went, uint8_t byte) {
    if (!answering_) {
      answering_ = true;
      answer_bytes_ = 0;
    }
    last_write_went_ = went;
    if (!went) return;
    if (answer_bytes_ == 1) answered(byte);
    ++answer_bytes_;
  }

  // One tick's command, where the servo stands, and whether it lets anything begin.
  void commanded(const hal::ServoCommand& command, int64_t stands, bool commits) {
    hear_broadcasts();
    ++tick_;
    if (command.enabled && !on_) switched_on(command.setpoint, stands);
    if (!command.enabled) switched_off();
    if (command.enabled && on_) moved(command.setpoint, commits);
    on_ = command.enabled;
    setpoint_ = command.setpoint;
  }

  // Told where no command comes: the link is dead.
  void disabled() {
    switched_off();
    on_ = false;
  }

 private:
  static constexpr size_t kMostBytes = 4096;
  static constexpr double kLsb = 4294967296.0;
  static constexpr uint32_t kStandsTicks = 2500;  // longer than any shaper that the line can hold

  void forget_bytes() {
    bytes_.clear();
    begins_.clear();
  }

  // What was taken last is the request: from any of the pauses on, since how long one must be is the drive's to say.
  void answered(uint8_t function) {
    const auto asked = [function](const uint8_t* frame) { return frame[0] == 1 && frame[1] == function; };
    each_frame(asked);
    forget_bytes();
  }

  // What goes to all has no answer. It may change the limits and lead the drive back to ready; no more is granted.
  void hear_broadcasts() {
    if (heard_all_) return;
    heard_all_ = true;
    to_all_ = true;
    each_frame([](const uint8_t* frame) { return frame[0] == 0; });
    to_all_ = false;
  }

  template <typename Condition>
  void each_frame(const Condition& condition) {
    for (const size_t begin : begins_) {
      const uint8_t* frame = bytes_.data() + begin;
      const size_t length = bytes_.size() - begin;
      if (length >= 8 && condition(frame) && reference_crc(frame, length) == 0) request(frame, length - 2);
    }
  }

  static uint32_t word(const uint8_t* at) { return (uint32_t{at[0]} << 8) | at[1]; }

  void request(const uint8_t* frame, size_t length) {
    const uint8_t function = frame[1];
    if (function == 6) put(word(frame + 2), word(frame + 4));
    if (function == 16 && length > 7) put_all(word(frame + 2), frame + 7, length - 7);
    if (function == 23 && length > 11) put_all(word(frame + 6), frame + 11, length - 11);
    if (function == 22 && length >= 8) mask(word(frame + 2), word(frame + 4), word(frame + 6));
  }

  void put_all(uint32_t address, const uint8_t* data, size_t bytes) {
    for (size_t i = 0; i + 1 < bytes; i += 2) put(address + static_cast<uint32_t>(i / 2), word(data + i));
    for (size_t i = 0; i + 3 < bytes; i += 2) {
      put_wide(address + static_cast<uint32_t>(i / 2), (word(data + i) << 16) | word(data + i + 2));
    }
  }

  // The map's column L, and the keys that do something (drive-map). What goes to all has no answer to tell by.
  static bool locked(uint32_t address, uint32_t value) {
    if (address == 0x0014) return value == 0x5341 || value == 0x4C44 || value == 0x5253;
    return (address >= 0x0020 && address <= 0x0023) || (address >= 0x0056 && address <= 0x005D) || address == 0x0066 ||
           (address >= 0x006C && address <= 0x006E) || (address >= 0x0074 && address <= 0x0079);
  }

  void put(uint32_t address, uint32_t value) {
    if (address == 0x0014 && value == 0x554E) unlocked_ = true;
    if (locked(address, value) && !unlocked_ && !to_all_) fail("a locked register is written without the key");
    if (address == 0x0040) {
      // Whatever bit 7 is: the drive takes it for the fault reset's alone, and a command beside it as it stands.
      if (!to_all_) asks_on_ = (value & 0x0F) == 0x0F;
      if ((value & 0x07) == 0x06 || (value & 0x0F) == 0x07) ready_ = true;
      if ((value & 0x10) != 0) cause(kSetPoint);
    }
    soft_.put(address, value, !to_all_);
    if ((address == 0x0052 || address == 0x0053) && value != 0) cause(kVelocity);
    if (address == 0x0042) in_velocity_ = value == 3 || to_all_;
    if (address == 0x0200 && (value == 1 || value == 3)) cause(kTune);
    if (address == 0x0200) tunes_ = value != 2;
    if (address >= 0x0090 && address < 0x00D0) streamed_ = true;
    if (address == 0x006A && value != 3) jerk_limited_ = false;
  }

  void put_wide(uint32_t address, uint32_t value) {
    soft_.put_wide(address, value);
    if (address == 0x0052 && !to_all_) wants_velocity_ = value != 0;
    if (address == 0x0058) velocity_ = std::max(velocity_, double{1.0} * value);
    if (address == 0x005A) acceleration_ = std::max(acceleration_, double{1.0} * value);
    if (address == 0x005C) jerk_ = std::max(jerk_, 1000.0 * value);
  }

  void mask(uint32_t address, uint32_t keep, uint32_t with) {
    // Of a key, which cannot be read, what was kept is 0.
    if (locked(address, with & ~keep) && !unlocked_ && !to_all_) fail("a locked register is masked without the key");
    if (address == 0x0040) {
      if (!to_all_) asks_on_ = true;
      ready_ = true;
      if ((with & ~keep & 0x10) != 0) cause(kSetPoint);
    }
    soft_.put(address, with, false);
    if (address == 0x0042) in_velocity_ = true;
    const uint32_t command = with & ~keep;
    if (address == 0x0200 && (command == 1 || command == 3)) {
      cause(kTune);
      tunes_ = true;
    }
    if (address == 0x006A) jerk_limited_ = false;
  }

  enum Cause : uint32_t { kSetPoint = 1, kVelocity = 2, kTune = 4 };
  void cause(Cause what) {
    if (!on_ || to_all_) return;  // what comes before is lost, so that enabling never starts a motion
    causes_ |= what;
    stood_ = 0;
  }

  void switched_on(int64_t setpoint, int64_t stands) {
    if (!asks_on_) fail("the output stage comes on, and the last controlword does not ask for it");
    if (!ready_) fail("the output stage comes on without the way through ready to switch on");
    if (setpoint != stands) fail("the output stage comes on away from the actual position");
    ready_ = false;
    step_ = 0;
    change_ = 0;
  }

  void switched_off() {
    causes_ = 0;
    streamed_ = false;
    stood_ = 0;
  }

  void moved(int64_t setpoint, bool commits) {
    const int64_t step = setpoint - setpoint_;
    const int64_t change = step - step_;
    const double jerk = static_cast<double>(change) - static_cast<double>(change_);
    constexpr double kTick = 0.001;
    constexpr double kRoundings = 64.0;  // LSB; the shaper's stages and more
    if (step != 0 && causes_ == 0) fail("the setpoint moves, and no client has asked for it");
    if (over(static_cast<double>(step), velocity_ * kTick * kLsb, kRoundings)) fail("faster than the registers permit");
    if (over(static_cast<double>(change), acceleration_ * kTick * kTick * kLsb, kRoundings)) {
      fail("a steeper acceleration than the registers permit");
    }
    if (jerk_limited_ && over(jerk, jerk_ * kTick * kTick * kTick * kLsb, 2.0 * kRoundings)) {
      fail("a steeper jerk than the registers permit");
    }
    if (soft_.left(setpoint_, setpoint)) fail("the setpoint leaves the soft limits");
    step_ = step;
    change_ = change;
    drop_causes(step != 0, commits);
  }

  // Once it has stood for longer than anything asked for can still be on its way: a set-point excuses one motion; a
  // velocity the one until it is 0, or another mode is chosen; a tuning all of its own until it is aborted. A tuning
  // that ends by itself, and a stream that is fed, go on when they will.
  void drop_causes(bool moves, bool commits) {
    if (moves) stood_ = 0;
    if (!moves && commits) ++stood_;
    if (stood_ <= kStandsTicks) return;
    if (!in_velocity_ || !wants_velocity_) causes_ &= ~uint32_t{kVelocity};
    if (!tunes_) causes_ &= ~uint32_t{kTune};
    if (causes_ == kSetPoint && !streamed_) causes_ = 0;
  }

  static bool over(double value, double limit, double slack) { return (value < 0 ? -value : value) > limit + slack; }

  void fail(const char* what) {
    if (broken_ == nullptr) broken_ = what;
  }

  const char* broken_ = nullptr;
  uint32_t tick_ = 0;

  std::vector<uint8_t> bytes_;  // taken since the last answer
  std::vector<size_t> begins_;  // of what came after a pause
  uint32_t byte_tick_ = 0;
  bool heard_all_ = true;
  bool to_all_ = false;  // the frame that is looked at
  bool answering_ = false;
  bool last_write_went_ = false;
  size_t answer_bytes_ = 0;

  bool asks_on_ = false;   // the last controlword
  bool unlocked_ = false;  // once; a programme is shorter than the key is good for
  bool ready_ = false;     // one has led to ready to switch on, or to switched on, since the output stage came on
  uint32_t causes_ = 0;
  bool streamed_ = false;
  bool in_velocity_ = false;     // the mode asked for is that, or may be
  bool wants_velocity_ = false;  // the last one asked for is not 0
  bool tunes_ = false;           // not aborted since it was started

  SoftLimitWatch soft_;

  // The most that has been permitted, as delivered at first (10 unit/s, 1000 unit/s^2, 1e6 unit/s^3).
  double velocity_ = 1e7;
  double acceleration_ = 1e9;
  double jerk_ = 1e12;
  bool jerk_limited_ = true;

  bool on_ = false;
  int64_t setpoint_ = 0;
  int64_t step_ = 0;
  int64_t change_ = 0;
  uint32_t stood_ = 0;
};

}  // namespace stillpoint::testing
