// SPDX-License-Identifier: Apache-2.0
// Stored parameters on the production image in the emulator, which has the flash's memory but no controller: a save
// fails by name; an image that the host's model wrote, put there by the loader, is what the chip starts on.
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "sim/hil/session.hpp"
#include "sim/hil/usart_lock.hpp"
#include "sim/simulated_drive.hpp"
#include "tests/firmware/drive402.hpp"
#include "tests/support/flash_model.hpp"
#include "tests/support/random.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

const std::string kElf = STILLPOINT_CHIP_TREE "/stillpoint.elf";
constexpr uint32_t kFirstPage = 0x080C0000;
constexpr uint32_t kPageStride = 0x00020000;

struct Chip {
  sim::UsartLock lock;
  sim::SimulatedDrive arm{sim::SimulatedDriveConfig{}};
  sim::Session session;

  explicit Chip(const std::vector<std::string>& arguments = {}, uint8_t unit = 1)
      : lock(kElf, sim::kProductionClock, arguments), session(lock, arm, {}, unit) {}
  uint32_t get(uint16_t address) { return session.read(address, 1)[0]; }
};

// The model's pages as files that the loader takes; gone with this.
class PageFiles {
 public:
  explicit PageFiles(const FlashModel& flash) {
    for (size_t page = 0; page < FlashModel::kPages; ++page) {
      char path[] = "/tmp/stillpoint-page-XXXXXX";
      const int fd = ::mkstemp(path);
      TEST_ASSERT_TRUE(fd >= 0);
      ::close(fd);
      paths_[page] = path;
      std::ofstream file(path, std::ios::binary);
      for (const uint32_t word : flash.pages[page]) {
        for (int shift = 0; shift < 32; shift += 8) file.put(static_cast<char>(word >> shift));
      }
      char address[16];
      std::snprintf(address, sizeof address, "0x%08X", kFirstPage + static_cast<uint32_t>(page) * kPageStride);
      arguments_.insert(arguments_.end(), {"-device", "loader,file=" + paths_[page] + ",addr=" + address});
    }
  }
  ~PageFiles() {
    for (const std::string& path : paths_) std::remove(path.c_str());
  }
  const std::vector<std::string>& arguments() const { return arguments_; }

 private:
  std::string paths_[FlashModel::kPages];
  std::vector<std::string> arguments_;
};

// The same firmware on the host, with the model for its flash.
struct OnHost : Drive402 {
  explicit OnHost(FlashModel& flash) { drive.begin(axis, {&servo, &line, &dog, nullptr, nullptr, &flash}); }
  void save() {
    unlock();
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0014, 0x5341));
    step(50);
    TEST_ASSERT_EQUAL_UINT32(2, get(0x0015));
  }
};

}  // namespace

TEST(a_save_fails_by_name_where_the_flash_does_not_respond_and_the_drive_goes_on) {
  Chip chip;
  chip.session.write(0x0014, uint16_t{0x554E});
  chip.session.write(0x0014, uint16_t{0x5341});
  uint32_t result = 1;
  for (int i = 0; i < 100 && result == 1; ++i) result = chip.get(0x0015);
  TEST_ASSERT_EQUAL_UINT32(3, result);
  TEST_ASSERT_EQUAL_UINT32(0x8900, chip.get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0x0014, chip.get(0x0013));
  for (const uint16_t word : {uint16_t{0x06}, uint16_t{0x07}, uint16_t{0x0F}}) chip.session.write(0x0040, word);
  uint32_t state = 0;
  for (int i = 0; i < 100 && state != 0x27; ++i) state = chip.get(0x0041) & 0x6F;
  TEST_ASSERT_EQUAL_UINT32(0x27, state);
}

TEST(a_set_that_was_saved_is_what_the_chip_starts_on) {
  FlashModel flash;
  {
    OnHost host(flash);
    TEST_ASSERT_EQUAL_UINT32(0, host.write_wide(0x0060, 1));
    host.save();  // page 0, the older one
    TEST_ASSERT_EQUAL_UINT32(0, host.write_wide(0x0060, 765432));
    host.unlock();
    TEST_ASSERT_EQUAL_UINT32(0, host.write_wide(0x0058, 8000000));
    TEST_ASSERT_EQUAL_UINT32(0, host.write_single(0x0020, 9));
    TEST_ASSERT_EQUAL_UINT32(0, host.write_single(0x0101, 7));
    TEST_ASSERT_EQUAL_UINT32(0, host.write(0x0100, {1, 7, 0x0001, 0xADB0, 11000, 0, 1}));
    host.save();
  }
  const PageFiles files(flash);
  Chip chip(files.arguments(), 9);
  TEST_ASSERT_EQUAL_UINT32(765432, chip.session.read32(0x0060));
  TEST_ASSERT_EQUAL_UINT32(8000000, chip.session.read32(0x0058));
  TEST_ASSERT_EQUAL_UINT32(9, chip.get(0x0020));
  TEST_ASSERT_EQUAL_UINT32(0, chip.get(0x0012));
  chip.session.write(0x0101, uint16_t{7});
  TEST_ASSERT_EQUAL_UINT32(1, chip.get(0x0100));
  TEST_ASSERT_EQUAL_UINT32(110000, chip.session.read32(0x0102));
  TEST_ASSERT_EQUAL_UINT32(11000, chip.get(0x0104));
}

// Tuned, saved, power off and on: shaped as before, with nothing for a client to do.
TEST(the_shaper_in_force_when_it_was_saved_is_in_force_on_the_chip) {
  FlashModel flash;
  uint32_t delay_us = 0;
  uint32_t residual = 0;
  {
    OnHost host(flash);
    TEST_ASSERT_EQUAL_UINT32(0, host.write(0x0100, {1, 5, 0x0001, 0xADB0, 11000, 500, 5}));
    TEST_ASSERT_EQUAL_UINT32(0, host.write_single(0x0130, 1));
    host.step(100);
    TEST_ASSERT_EQUAL_UINT32(1, host.get(0x0131));
    delay_us = host.get_wide(0x0134);
    residual = host.get(0x0136);
    host.save();
  }
  const PageFiles files(flash);
  Chip chip(files.arguments());
  uint32_t state = 2;
  for (int i = 0; i < 1000 && state == 2; ++i) state = chip.get(0x0131);
  TEST_ASSERT_EQUAL_UINT32(1, state);
  TEST_ASSERT_EQUAL_UINT32(delay_us, chip.session.read32(0x0134));
  TEST_ASSERT_EQUAL_UINT32(residual, chip.get(0x0136));
  TEST_ASSERT_EQUAL_UINT32(0, chip.get(0x0011));
  TEST_ASSERT_EQUAL_UINT32(0, chip.get(0x0012));
}

TEST(a_save_that_was_cut_leaves_the_set_before_it_on_the_chip_too) {
  FlashModel flash;
  {
    OnHost host(flash);
    TEST_ASSERT_EQUAL_UINT32(0, host.write_wide(0x0060, 111));
    host.save();
    TEST_ASSERT_EQUAL_UINT32(0, host.write_wide(0x0060, 222));
    host.unlock();
    flash.cut_at(200, 7);
    TEST_ASSERT_EQUAL_UINT32(0, host.write_single(0x0014, 0x5341));
    host.step(50);
    TEST_ASSERT_EQUAL_UINT32(3, host.get(0x0015));
  }
  const PageFiles files(flash);
  Chip chip(files.arguments());
  TEST_ASSERT_EQUAL_UINT32(111, chip.session.read32(0x0060));
}

TEST(a_memory_of_which_no_set_is_whole_is_a_fault_by_name_and_the_drive_runs_as_delivered) {
  FlashModel flash;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    TEST_INFO("seed", seed);
    Random random(seed);
    {
      OnHost host(flash);
      for (const int64_t velocity : {111, 222}) {
        TEST_ASSERT_EQUAL_UINT32(0, host.write_wide(0x0060, velocity));
        host.save();
      }
    }
    for (std::vector<uint32_t>& page : flash.pages) {
      page[static_cast<size_t>(random.integer(0, 60))] ^= uint32_t{1} << random.integer(0, 31);
    }
    const PageFiles files(flash);
    Chip chip(files.arguments());
    uint32_t fault = 0;
    for (int i = 0; i < 100 && fault == 0; ++i) fault = chip.get(0x0010);
    TEST_ASSERT_EQUAL_UINT32(0x6310, fault);
    TEST_ASSERT_EQUAL_UINT32(0x8A01, chip.get(0x0012));
    TEST_ASSERT_EQUAL_UINT32(0x6310, chip.get(0x0500));
    TEST_ASSERT_EQUAL_UINT32(0x08, chip.get(0x0041) & 0x4F);
    TEST_ASSERT_EQUAL_UINT32(1200000, chip.session.read32(0x0060));
    chip.session.write(0x0040, uint16_t{0x80});
    for (const int word : {0x00, 0x06, 0x07, 0x0F}) chip.session.write(0x0040, static_cast<uint16_t>(word));
    uint32_t state = 0;
    for (int i = 0; i < 100 && state != 0x27; ++i) state = chip.get(0x0041) & 0x6F;
    TEST_ASSERT_EQUAL_UINT32(0x27, state);
  }
}
