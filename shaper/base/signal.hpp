// SPDX-License-Identifier: Apache-2.0
// The fixed-point signal of the setpoint path.
#pragma once

#include <stdint.h>

namespace stillpoint {

// A position: counts times 2^32, range [-2^31, 2^31 - 1] counts. One LSB is 2.3e-10 counts. Fractions are kept
// because whole counts alone leave 1e-4 of the plain vibration and their third difference drowns a jerk limit.
using Signal = int64_t;

constexpr int kSignalFractionBits = 32;
constexpr Signal kSignalPerCount = Signal{1} << kSignalFractionBits;

constexpr int32_t kMinPositionCounts = INT32_MIN;
constexpr int32_t kMaxPositionCounts = INT32_MAX;

constexpr Signal signal_from_counts(int32_t position_counts) { return Signal{position_counts} * kSignalPerCount; }

// Nearest whole count, halves up; saturates at the ends of the position range.
constexpr int32_t counts_from_signal(Signal signal) {
  const int64_t whole = signal >> kSignalFractionBits;
  const bool up = ((signal >> (kSignalFractionBits - 1)) & 1) != 0;
  return static_cast<int32_t>(up && whole < kMaxPositionCounts ? whole + 1 : whole);
}

// Modulo 2^64: positions wrap at the end of their range, and what they differ by does not notice.
constexpr Signal wrapping_sum(Signal a, Signal b) {
  return static_cast<Signal>(static_cast<uint64_t>(a) + static_cast<uint64_t>(b));
}
constexpr Signal wrapping_difference(Signal a, Signal b) {
  return static_cast<Signal>(static_cast<uint64_t>(a) - static_cast<uint64_t>(b));
}

}  // namespace stillpoint
