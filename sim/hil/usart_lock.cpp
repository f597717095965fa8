// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/usart_lock.hpp"

#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cerrno>
#include <thread>

namespace stillpoint::sim {
namespace {

// A sync that comes before the firmware listens is lost, as on silicon.
constexpr std::chrono::milliseconds kUsualBoot{50};
constexpr std::chrono::milliseconds kProbeInterval{200};
constexpr int kProbes = 100;

constexpr std::chrono::microseconds kDrainStep{50};

Emulator::Options options_for(const std::string& elf, EmulatorClock clock, int client_fd, int servo_fd,
                              const std::vector<std::string>& arguments) {
  Emulator::Options options;
  options.elf = elf;
  options.clock = clock;
  options.inherited = {client_fd, servo_fd};
  options.arguments = {"-chardev", "socket,id=client,fd=" + std::to_string(client_fd),
                       "-chardev", "socket,id=servo,fd=" + std::to_string(servo_fd),
                       "-serial",  "chardev:client",
                       "-serial",  "chardev:servo"};
  options.arguments.insert(options.arguments.end(), arguments.begin(), arguments.end());
  return options;
}

}  // namespace

bool SocketStream::read(uint8_t& byte) {
  if (next_ == end_) {
    const ssize_t got = ::recv(fd_, buffer_, sizeof buffer_, MSG_DONTWAIT);
    if (got <= 0) return false;  // an emulator that ended shows on the servo link
    next_ = 0;
    end_ = static_cast<size_t>(got);
  }
  byte = buffer_[next_++];
  return true;
}

bool SocketStream::write(uint8_t byte) {
  unsent_.push_back(byte);
  return true;
}

void SocketStream::flush() {
  if (unsent_.empty()) return;
  const ssize_t sent = ::send(fd_, unsent_.data(), unsent_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent > 0) unsent_.erase(unsent_.begin(), unsent_.begin() + sent);
}

// Counts what the other end has not read yet: unix(7).
bool SocketStream::drained() const {
  int bytes = 0;
  return unsent_.empty() && ::ioctl(fd_, SIOCOUTQ, &bytes) == 0 && bytes == 0;
}

UsartLock::UsartLock(const std::string& elf, EmulatorClock clock, const std::vector<std::string>& arguments)
    : emulator_(options_for(elf, clock, client_line_.theirs.get(), servo_line_.theirs.get(), arguments)),
      client_stream_(client_line_.ours.get()) {
  client_line_.theirs.reset();
  servo_line_.theirs.reset();
}

hal::ServoCommand UsartLock::exchange(const hal::ServoFeedback& sync) {
  if (!booted_) wait_for_boot(sync);
  deliver_client_bytes();
  send(sync);
  return receive(sync.sequence);
}

// Before the tick, all of it. The emulated lines have no baud rate: a sync's bytes come as fast as the firmware takes
// them, its client line has the lower priority, and one byte in several ticks is silence to Modbus (2026-11: 5 pieces a
// request at 10,000 ticks a second).
void UsartLock::deliver_client_bytes() {
  for (std::chrono::microseconds waited{0}; !client_stream_.drained(); waited += kDrainStep) {
    client_stream_.flush();
    if (emulator_.ended()) emulator_.refuse_ended();
    if (waited > kEmulatorPatience) emulator_.refuse_silent("client line");
    std::this_thread::sleep_for(kDrainStep);
  }
}

void UsartLock::wait_for_boot(const hal::ServoFeedback& first) {
  hal::ServoFeedback probe = first;
  probe.sequence = static_cast<uint16_t>(first.sequence - 1);
  probe.commit = false;
  hal::ServoCommand unused{};
  emulator_.wait_readable_for(servo_line_.ours.get(), kUsualBoot);
  for (int i = 0; i < kProbes; ++i) {
    send(probe);
    while (emulator_.wait_readable_for(servo_line_.ours.get(), kProbeInterval)) {
      booted_ = take_bytes(probe.sequence, unused);
      if (booted_) return;
    }
  }
  emulator_.refuse_silent("reply on the servo link");
}

void UsartLock::send(const hal::ServoFeedback& sync) {
  uint8_t frame[servo_link::kSyncBytes];
  servo_link::encode_sync(sync, frame);
  send_frame(frame);
}

void UsartLock::send_damaged(const hal::ServoFeedback& sync, uint32_t bit) {
  uint8_t frame[servo_link::kSyncBytes];
  servo_link::encode_sync(sync, frame);
  frame[bit / 8] = static_cast<uint8_t>(frame[bit / 8] ^ 1U << bit % 8);
  send_frame(frame);
}

void UsartLock::pause(std::chrono::microseconds time) {
  deliver_client_bytes();
  std::this_thread::sleep_for(time);
}

void UsartLock::send_frame(const uint8_t (&frame)[servo_link::kSyncBytes]) {
  // The other end takes all of it: a socket holds thousands of frames, and at most one is under way.
  if (::send(servo_line_.ours.get(), frame, sizeof frame, MSG_NOSIGNAL) != static_cast<ssize_t>(sizeof frame)) {
    emulator_.refuse_ended();
  }
}

hal::ServoCommand UsartLock::receive(uint16_t sequence) {
  hal::ServoCommand command{};
  do {
    emulator_.wait_readable(servo_line_.ours.get(), "reply on the servo link");
  } while (!take_bytes(sequence, command));
  return command;
}

bool UsartLock::take_bytes(uint16_t sequence, hal::ServoCommand& command) {
  uint8_t bytes[256];
  const ssize_t got = ::recv(servo_line_.ours.get(), bytes, sizeof bytes, 0);
  if (got == 0 || (got < 0 && errno != EINTR)) emulator_.refuse_ended();
  bool found = false;
  servo_link::Reply reply{};
  for (ssize_t i = 0; i < got; ++i) {
    if (reader_.push(bytes[i], reply) && reply.sequence == sequence) {
      command = reply.command;
      found = true;
    }
  }
  return found;
}

}  // namespace stillpoint::sim
