// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "sim/hil/campaign_record.hpp"
#include "sim/hil/emulator.hpp"
#include "sim/hil/lock.hpp"

namespace stillpoint::sim {

// A directory for the two FIFOs; gone, with them, when this is.
class FifoDirectory {
 public:
  FifoDirectory();
  ~FifoDirectory() { remove(); }
  FifoDirectory(const FifoDirectory&) = delete;
  FifoDirectory& operator=(const FifoDirectory&) = delete;

  const std::string& path() const { return path_; }
  void remove();

 private:
  std::string path_;
};

// The client line as far as it lies on the host.
class QueuedStream final : public hal::ByteStream {
 public:
  bool read(uint8_t& byte) override;
  bool write(uint8_t byte) override;

  std::deque<uint8_t> to_chip;
  std::deque<uint8_t> from_chip;
};

// The test image: fast, and repeatable to the bit in everything, the client's line included.
class CampaignLock final : public Lock {
 public:
  CampaignLock(const std::string& elf, Pace pace);

  hal::ServoCommand exchange(const hal::ServoFeedback& sync) override;
  hal::ByteStream& client() override { return client_stream_; }
  std::optional<TickCost> cost() const override { return cost_; }

 private:
  void send(const hal::ServoFeedback& sync);
  CampaignFromChip receive();

  Pace pace_;
  FifoDirectory directory_;
  FileDescriptor to_chip_;
  FileDescriptor from_chip_;
  Emulator emulator_;
  QueuedStream client_stream_;
  std::optional<TickCost> cost_;
};

}  // namespace stillpoint::sim
