// SPDX-License-Identifier: Apache-2.0
// A drive in one of its modes, enabled, and a client of it.
#pragma once

#include <cmath>

#include "tests/firmware/drive402.hpp"
#include "tests/support/stream_check.hpp"

namespace stillpoint::testing {

constexpr uint32_t kBit12 = 1U << 12;
constexpr uint32_t kBit13 = 1U << 13;

struct InMode : Enabled402 {
  explicit InMode(uint32_t mode) {
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, mode));
    step(2);
    TEST_ASSERT_EQUAL_UINT32(mode, get(0x0043));
  }
  void velocity(int64_t counts_per_s) { TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0052, counts_per_s)); }
  // The newest step of the setpoint, counts/s.
  double speed() const {
    const auto& all = servo.commands;
    return static_cast<double>(all.back().setpoint - all[all.size() - 2].setpoint) / 4294967296.0 * 1e3;
  }
  void within_limits() {
    StreamCheck check(0, true, AxisLimits{1.2e6, 20e6, 20e6, 600e6}, 1e-3);
    for (const hal::ServoCommand& command : servo.commands) check.next(command.setpoint);
    TEST_ASSERT_TRUE(check.within(0));
  }
};

struct Velocity : InMode {
  Velocity() : InMode(3) {}
};
struct Homing : InMode {
  Homing() : InMode(6) {}
};

struct Streamed : InMode {
  Streamed() : InMode(8) {}

  uint32_t send_positions(const std::vector<int32_t>& positions) {
    std::vector<uint16_t> words;
    for (const int32_t position : positions) {
      words.push_back(static_cast<uint16_t>(static_cast<uint32_t>(position) >> 16));
      words.push_back(static_cast<uint16_t>(position));
    }
    return write(0x0090, words);
  }
  // A slow swing of 20,000 counts, a position every 50 ticks.
  static int32_t swing(int n) { return static_cast<int32_t>(std::lround(10000.0 * (1.0 - std::cos(0.1 * n)))); }
  std::vector<int32_t> swings(int from, int count) {
    std::vector<int32_t> positions;
    for (int n = from; n < from + count; ++n) positions.push_back(swing(n));
    return positions;
  }
};

}  // namespace stillpoint::testing
