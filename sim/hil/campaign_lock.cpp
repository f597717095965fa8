// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/campaign_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

[[noreturn]] void refuse_system(const std::string& value) {
  throw Refusal(Refusal::Cause::kCannot, "emulator", value, std::strerror(errno), "emulator_failed");
}

FileDescriptor open_fifo(const std::string& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0) refuse_system(path);
  return FileDescriptor(fd);
}

// Timers run at 1 GHz, so with shift n an instruction is 2^n counts.
int shift_of(Pace pace) { return pace == Pace::kLock ? 0 : 3; }

Emulator::Options options_for(const std::string& elf, Pace pace, const std::string& directory) {
  Emulator::Options options;
  char* absolute = ::realpath(elf.c_str(), nullptr);  // the emulator runs elsewhere
  options.elf = absolute == nullptr ? elf : absolute;
  std::free(absolute);
  options.clock.instruction_shift = shift_of(pace);
  options.directory = directory;
  options.arguments = {"-serial", "none", "-semihosting-config", "enable=on,target=native"};
  return options;
}

uint32_t number(const uint8_t (&bytes)[4]) {
  return static_cast<uint32_t>(bytes[0]) | static_cast<uint32_t>(bytes[1]) << 8 |
         static_cast<uint32_t>(bytes[2]) << 16 | static_cast<uint32_t>(bytes[3]) << 24;
}

}  // namespace

FifoDirectory::FifoDirectory() {
  const char* base = std::getenv("TMPDIR");
  path_ = std::string(base == nullptr || *base == '\0' ? "/tmp" : base) + "/stillpoint-XXXXXX";
  if (::mkdtemp(path_.data()) == nullptr) refuse_system(path_);
  for (const char* name : {STILLPOINT_CAMPAIGN_IN, STILLPOINT_CAMPAIGN_OUT}) {
    if (::mkfifo((path_ + "/" + name).c_str(), 0600) != 0) refuse_system(path_ + "/" + name);
  }
}

void FifoDirectory::remove() {
  if (path_.empty()) return;
  ::unlink((path_ + "/" STILLPOINT_CAMPAIGN_IN).c_str());
  ::unlink((path_ + "/" STILLPOINT_CAMPAIGN_OUT).c_str());
  ::rmdir(path_.c_str());
  path_.clear();
}

bool QueuedStream::read(uint8_t& byte) {
  if (from_chip.empty()) return false;
  byte = from_chip.front();
  from_chip.pop_front();
  return true;
}

bool QueuedStream::write(uint8_t byte) {
  to_chip.push_back(byte);
  return true;
}

// Opening for both directions does not wait for the other end.
CampaignLock::CampaignLock(const std::string& elf, Pace pace)
    : pace_(pace),
      to_chip_(open_fifo(directory_.path() + "/" STILLPOINT_CAMPAIGN_IN, O_RDWR)),
      from_chip_(open_fifo(directory_.path() + "/" STILLPOINT_CAMPAIGN_OUT, O_RDONLY | O_NONBLOCK)),
      emulator_(options_for(elf, pace, directory_.path())) {}

hal::ServoCommand CampaignLock::exchange(const hal::ServoFeedback& sync) {
  send(sync);
  const CampaignFromChip record = receive();
  directory_.remove();  // both ends are open now; a crash from here on leaves nothing behind
  for (size_t i = 0; i < record.client_bytes && i < sizeof record.client; ++i) {
    client_stream_.from_chip.push_back(record.client[i]);
  }
  cost_ = TickCost{number(record.timer_counts) >> shift_of(pace_), number(record.late_ticks)};
  servo_link::Reply reply{};
  if (!servo_link::decode_reply(record.reply, reply) || reply.sequence != sync.sequence) {
    throw Refusal(Refusal::Cause::kCannot, "emulator", "reply on the servo link",
                  "not an answer to the sync, the test image of this version is accepted", "emulator_silent");
  }
  return reply.command;
}

void CampaignLock::send(const hal::ServoFeedback& sync) {
  CampaignToChip record = {};
  servo_link::encode_sync(sync, record.sync);
  record.pace = pace_ == Pace::kLock ? kPaceLock : kPaceFreeSysTick;
  auto& queue = client_stream_.to_chip;
  while (!queue.empty() && record.client_bytes < sizeof record.client) {
    record.client[record.client_bytes++] = queue.front();
    queue.pop_front();
  }
  if (::write(to_chip_.get(), &record, sizeof record) != static_cast<ssize_t>(sizeof record)) {
    refuse_system(STILLPOINT_CAMPAIGN_IN);
  }
}

CampaignFromChip CampaignLock::receive() {
  CampaignFromChip record = {};
  auto* bytes = reinterpret_cast<uint8_t*>(&record);
  for (size_t have = 0; have < sizeof record;) {
    emulator_.wait_readable(from_chip_.get(), STILLPOINT_CAMPAIGN_OUT);
    const ssize_t got = ::read(from_chip_.get(), bytes + have, sizeof record - have);
    if (got == 0) emulator_.refuse_ended();
    if (got > 0) have += static_cast<size_t>(got);
  }
  return record;
}

}  // namespace stillpoint::sim
