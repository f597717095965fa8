// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/servo_link.hpp"
#include "sim/hil/emulator.hpp"
#include "sim/hil/lock.hpp"

namespace stillpoint::sim {

// A serial line of the emulator. Never waits. What is written goes out with `flush`.
class SocketStream final : public hal::ByteStream {
 public:
  explicit SocketStream(int fd) : fd_(fd) {}
  bool read(uint8_t& byte) override;
  bool write(uint8_t byte) override;
  void flush();
  // Nothing is on its way to the emulator.
  bool drained() const;

 private:
  int fd_;
  std::vector<uint8_t> unsent_;
  uint8_t buffer_[256] = {};
  size_t next_ = 0;
  size_t end_ = 0;
};

// How the production image runs: a nanosecond an instruction, so its own millisecond is about 4 of the host's and the
// drive waits 0.4 s for a host that is not scheduled, not 0.1 s. Hashes are the same with every clock; what differs is
// how long the host may pause (measured 2026-11, QEMU 7.2, two loaded cores, a move of 1.5 s):
//   clock         ticks a second   pauses of up to 50 ms   of up to 400 ms
//   the host's    500-1800         no fault in 4 runs      link-silent fault
//   shift=3       650-1900         fault in 4 of 4         link-silent fault
//   shift=0       680-1800         no fault in 4           link-silent fault
constexpr EmulatorClock kProductionClock{0};

// The production image, unchanged: USART1 is its client line, USART2 the servo link, whose syncs make its ticks.
class UsartLock final : public Lock {
 public:
  // `arguments`: further ones of the emulator's.
  UsartLock(const std::string& elf, EmulatorClock clock, const std::vector<std::string>& arguments = {});

  hal::ServoCommand exchange(const hal::ServoFeedback& sync) override;
  hal::ByteStream& client() override { return client_stream_; }
  std::optional<TickCost> cost() const override { return std::nullopt; }

  // A sync that has come to harm on its way: one bit of it, counted from the first byte's lowest, is turned. There is
  // no answer to wait for.
  void send_damaged(const hal::ServoFeedback& sync, uint32_t bit);

  // So long on the host without a sync; the client's line goes on.
  void pause(std::chrono::microseconds time);

 private:
  void wait_for_boot(const hal::ServoFeedback& first);
  void deliver_client_bytes();
  void send(const hal::ServoFeedback& sync);
  void send_frame(const uint8_t (&frame)[servo_link::kSyncBytes]);
  // Until the reply to that sync; what answers earlier ones is dropped.
  hal::ServoCommand receive(uint16_t sequence);
  bool take_bytes(uint16_t sequence, hal::ServoCommand& command);

  SocketPair client_line_;
  SocketPair servo_line_;
  Emulator emulator_;
  SocketStream client_stream_;
  servo_link::ReplyReader reader_;
  bool booted_ = false;
};

}  // namespace stillpoint::sim
