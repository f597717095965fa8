// SPDX-License-Identifier: Apache-2.0
// The firmware in the emulator as a drive that faults can be provoked on: at the other end of its servo link,
// and of its client's line.
#pragma once

#include <chrono>
#include <memory>
#include <utility>

#include "sim/hil/usart_lock.hpp"
#include "tests/firmware/faulty_drive.hpp"

namespace stillpoint::testing {

// This process was kept from running for so long that the chip may have heard nothing for its 100 ms.
struct HostTooSlow {};

class ChipDrive final : public FaultyDrive {
 public:
  // `random`: which bit of a frame is damaged.
  ChipDrive(std::unique_ptr<sim::Lock> lock, Random& random)
      : lock_(std::move(lock)), serial_(dynamic_cast<sim::UsartLock*>(lock_.get())), random_(random) {
    const uint32_t begun = get_wide(kUptime);
    step(kMeasuredTicks);
    ticks_a_ms_ = kMeasuredTicks / (get_wide(kUptime) - begun + 1) + 1;
  }

  void step_ticks(uint32_t ticks) override {
    for (uint32_t i = 0; i < ticks; ++i) {
      command_ = lock_->exchange(servo.exchange(command_));
      const Clock::time_point now = Clock::now();
      if (serial_ != nullptr && now - newest_ > kLongestPause && newest_ != Clock::time_point{}) throw HostTooSlow{};
      newest_ = now;
    }
  }
  uint32_t lag() const override { return 1; }

  // The production image's alone, as is silence: the test image has no line that bytes come to harm on.
  void damage_frames(uint32_t count) override {
    TEST_ASSERT_TRUE(serial_ != nullptr);
    for (uint32_t i = 0; i < count; ++i) {
      const auto bit = static_cast<uint32_t>(random_.integer(0, 8 * servo_link::kSyncBytes - 1));
      serial_->send_damaged({servo.position, 0, ++servo.sequence, true, true}, bit);
    }
  }

  void stay_silent(uint32_t ms) override {
    TEST_ASSERT_TRUE(serial_ != nullptr);
    const uint32_t begun = get_wide(kUptime);
    silent_ = true;
    while (get_wide(kUptime) - begun < ms) {
    }
    silent_ = false;
    newest_ = {};
  }

  // Its millisecond is the emulator's, which a host with more to do lets go on longer between two ticks, not shorter.
  uint32_t ticks_in(uint32_t ms) const override { return 4 * ticks_a_ms_ * ms; }

  void note(firmware::FaultCode) override { TEST_ASSERT_TRUE(false); }  // the image has no way to be told

  // Asked again where a byte came too late, as a client does: see sim::Session.
  Bytes exchange_with(uint8_t unit, const Bytes& pdu) override {
    Bytes body{unit};
    body.insert(body.end(), pdu.begin(), pdu.end());
    const Bytes frame = framed(body);
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      drain();
      for (const uint8_t byte : frame) lock_->client().write(byte);
      const Bytes got = answer();
      if (!got.empty()) return Bytes(got.begin() + 1, got.end() - 2);
    }
    return {};
  }

  uint32_t repeated() const { return repeated_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr uint16_t kUptime = 0x0004;
  static constexpr uint32_t kMeasuredTicks = 200;
  static constexpr int kAttempts = 40;
  static constexpr uint32_t kAnswerTicks = 300;
  static constexpr std::chrono::milliseconds kLongestPause{300};  // the chip's 100 ms take about 400
  static constexpr std::chrono::milliseconds kSilentStep{1};

  void drain() {
    uint8_t byte = 0;
    while (lock_->client().read(byte)) {
    }
  }

  Bytes answer() {
    Bytes got;
    for (uint32_t i = 0; i < kAnswerTicks; ++i) {
      if (silent_) {
        serial_->pause(kSilentStep);
      } else {
        step();
      }
      uint8_t byte = 0;
      while (lock_->client().read(byte)) got.push_back(byte);
      if (got.size() >= kShortestAnswer && reference_crc(got) == 0) return got;
    }
    ++repeated_;
    return {};
  }
  static constexpr size_t kShortestAnswer = 5;

  std::unique_ptr<sim::Lock> lock_;
  sim::UsartLock* serial_;  // null: the test image, which waits for its host
  Random& random_;
  hal::ServoCommand command_ = {};
  Clock::time_point newest_ = {};
  uint32_t ticks_a_ms_ = 1;
  bool silent_ = false;
  uint32_t repeated_ = 0;
};

}  // namespace stillpoint::testing
