// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/emulated_drive.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "firmware/application.hpp"
#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "sim/hil/lock.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

class NoWatchdog final : public hal::Watchdog {
 public:
  void feed() override {}
};

// The firmware's way to its restart is a plain function.
bool reset_asked = false;
void ask_for_reset() { reset_asked = true; }

class OnHost final : public EmulatedDrive {
 public:
  OnHost(sim::SimulatedDrive& arm, hal::ByteStream& client, PageFile* memory)
      : arm_(arm), client_(client), memory_(memory) {
    start();
  }
  void step() override {
    running_->application.tick();
    running_->application.own_timer_tick();
    // One takes a request, the next what it asks for; a third would find nothing.
    running_->application.poll();
    running_->application.poll();
    if (reset_asked) start();
  }

 private:
  struct Running {
    Axis<firmware::kLineCapacity> axis = {};
    firmware::Application application = {};
    TuneMemory tune_memory = {};
  };

  void start() {
    reset_asked = false;
    running_ = std::make_unique<Running>();
    sim::require(running_->axis.configure(firmware::kDefaultAxis));
    running_->application.begin(
        running_->axis, {&arm_, &client_, &watchdog_, &faults_, &running_->tune_memory, memory_, ask_for_reset});
  }

  sim::SimulatedDrive& arm_;
  hal::ByteStream& client_;
  PageFile* memory_;
  firmware::FaultMemory faults_ = {};
  NoWatchdog watchdog_;
  std::unique_ptr<Running> running_;
};

// The pages as files that the emulator's loader takes; gone with this.
class LoaderFiles {
 public:
  explicit LoaderFiles(const PageFile* memory) {
    if (memory == nullptr) return;
    for (size_t page = 0; page < PageFile::kPages; ++page) add(*memory, page);
  }
  ~LoaderFiles() {
    for (const std::string& path : paths_) std::remove(path.c_str());
  }
  LoaderFiles(const LoaderFiles&) = delete;
  LoaderFiles& operator=(const LoaderFiles&) = delete;

  const std::vector<std::string>& arguments() const { return arguments_; }

 private:
  // Where the chip has them.
  static constexpr uint32_t kFirstPage = 0x080C0000;
  static constexpr uint32_t kPageStride = 0x00020000;

  void add(const PageFile& memory, size_t page) {
    char path[] = "/tmp/stillpoint-page-XXXXXX";
    const int fd = ::mkstemp(path);
    if (fd < 0) throw sim::bad_argument("--memory", path, "cannot be made, a /tmp that can be written is accepted");
    ::close(fd);
    paths_.emplace_back(path);
    std::ofstream file(path, std::ios::binary);
    for (size_t i = 0; i < PageFile::kPageBytes; ++i)
      file.put(static_cast<char>(memory.bytes()[page * PageFile::kPageBytes + i]));
    char address[16];
    std::snprintf(address, sizeof address, "0x%08X", kFirstPage + static_cast<uint32_t>(page) * kPageStride);
    arguments_.insert(arguments_.end(), {"-device", "loader,file=" + paths_.back() + ",addr=" + address});
  }

  std::vector<std::string> paths_;
  std::vector<std::string> arguments_;
};

class OnChip final : public EmulatedDrive {
 public:
  OnChip(const std::string& elf, sim::SimulatedDrive& arm, hal::ByteStream& client, const PageFile* memory)
      : elf_(elf), arm_(arm), client_(client), files_(memory) {
    start();
  }
  void step() override {
    try {
      exchange();
    } catch (const sim::Refusal& refusal) {
      // One that resets itself as it starts would do nothing else.
      constexpr uint32_t kLeastTicks = 100;
      if (refusal.result() != "chip_reset" || ticks_ < kLeastTicks) throw;
      start();
    }
  }

 private:
  void start() {
    lock_ = sim::start_locked(elf_, sim::Pace::kLock, files_.arguments());
    command_ = {};
    ticks_ = 0;
  }
  void exchange() {
    ++ticks_;
    uint8_t byte = 0;
    while (client_.read(byte)) lock_->client().write(byte);
    command_ = lock_->exchange(arm_.exchange(command_));
    while (lock_->client().read(byte)) client_.write(byte);
  }

  std::string elf_;
  sim::SimulatedDrive& arm_;
  hal::ByteStream& client_;
  LoaderFiles files_;
  std::unique_ptr<sim::Lock> lock_;
  hal::ServoCommand command_ = {};
  uint32_t ticks_ = 0;
};

}  // namespace

std::unique_ptr<EmulatedDrive> firmware_on_host(sim::SimulatedDrive& arm, hal::ByteStream& client, PageFile* memory) {
  return std::make_unique<OnHost>(arm, client, memory);
}

std::unique_ptr<EmulatedDrive> firmware_on_chip(const std::string& elf, sim::SimulatedDrive& arm,
                                                hal::ByteStream& client, const PageFile* memory) {
  return std::make_unique<OnChip>(elf, arm, client, memory);
}

}  // namespace stillpoint::cli
