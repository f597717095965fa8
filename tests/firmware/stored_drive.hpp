// SPDX-License-Identifier: Apache-2.0
// A drive over power cycles: on memory that outlasts it.
#pragma once

#include <memory>

#include "tests/firmware/drive402.hpp"
#include "tests/support/flash_model.hpp"

namespace stillpoint::testing {

constexpr uint32_t kBusy = 6;
constexpr uint32_t kSave = 0x5341;
constexpr uint32_t kDefaults = 0x4C44;
constexpr uint32_t kReset = 0x5253;
enum Result : uint32_t { kIdle, kUnderWay, kDone, kFailed };

inline uint32_t restarts = 0;
inline void restart() { ++restarts; }

// A drive with the memory that it is given; another one on the same memory is the next start.
struct Stored : Drive402 {
  explicit Stored(hal::Nonvolatile* memory, const AxisConfig& config = firmware::kDefaultAxis) {
    TEST_ASSERT_OK(axis.configure(config));
    drive.begin(axis, {&servo, &line, &dog, &faults, nullptr, memory, restart});
  }

  uint32_t command(uint32_t key) {
    unlock();
    const uint32_t refused = write_single(0x0014, key);
    if (refused == 0) step(50);
    return refused;
  }
  uint32_t result() { return get(0x0015); }

  // 11 Hz, 0.11, of this kind, staged in this set and applied.
  void apply(uint16_t set, uint16_t kind) {
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, set, 0x0001, 0xADB0, 11000, 500, kind}));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    step(100);
    TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  }
};

struct Memory {
  FlashModel flash;
  std::unique_ptr<Stored> now = std::make_unique<Stored>(&flash);

  void power_cycle() { now = std::make_unique<Stored>(&flash); }

  // As another firmware can have saved it: an entry of the first image, and the image whole again.
  void replace(uint32_t key, uint32_t value) {
    auto& page = flash.pages[0];
    const uint32_t end = 3 + (page[1] & 0xFFFF);
    for (size_t i = 3; i < end; i += 2) {
      if (page[i] == key) page[i + 1] = value;
    }
    make_whole(0);
  }
  void make_whole(size_t at) {
    auto& page = flash.pages[at];
    const uint32_t end = 3 + (page[1] & 0xFFFF);
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < end; ++i) {
      for (int bit = 0; bit < 32; ++bit) crc = ((crc ^ (page[i] >> bit)) & 1) != 0 ? (crc >> 1) ^ 0xEDB88320 : crc >> 1;
    }
    page[end] = ~crc;
  }
};

}  // namespace stillpoint::testing
