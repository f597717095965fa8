// SPDX-License-Identifier: Apache-2.0
// A drive and a client of it, ready for CiA 402.
#pragma once

#include "tests/firmware/rig.hpp"

namespace stillpoint::testing {

constexpr uint32_t kTargetReached = 1U << 10;
constexpr uint32_t kTaken = 1U << 12;
constexpr int64_t kCount = int64_t{1} << 32;

// A client's move: 1e6 counts take 1.05 s or so.
struct Drive402 : Rig {
  using Rig::Rig;

  uint32_t state() { return status() & 0x006F; }
  void start_move(int32_t target, uint32_t word = 0x1F) {
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, target));
    control(word);
  }
  int64_t demand() { return static_cast<int32_t>(get_wide(0x004A)); }
};

struct Enabled402 : Drive402 {
  Enabled402() { enable(); }
};

}  // namespace stillpoint::testing
