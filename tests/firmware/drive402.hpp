// SPDX-License-Identifier: Apache-2.0
// A drive and a client of it, ready for CiA 402.
#pragma once

#include "tests/firmware/rig.hpp"

namespace stillpoint::testing {

constexpr uint32_t kTargetReached = 1U << 10;
constexpr uint32_t kTaken = 1U << 12;
constexpr int64_t kCount = int64_t{1} << 32;

struct Drive402 : Rig {
  using Rig::Rig;
};

struct Enabled402 : Drive402 {
  Enabled402() { enable(); }
};

}  // namespace stillpoint::testing
