// SPDX-License-Identifier: Apache-2.0
// Whether a setpoint leaves the soft limits, by what the client has written alone.
//
// Outside of them, where the encoder, other limits or no torque have left the axis, it may stand and go back in. Where
// the watch cannot tell what holds, it lets everything pass from then on: after homing, which shifts the limits against
// the servo; where a quick stop may be weaker than the motion that it stops, and so pass the end of that; after writes
// that may not have been taken.
#pragma once

#include <stdint.h>

namespace stillpoint::testing {

class SoftLimitWatch {
 public:
  // A word that has been written; or, not `sure`, that may have been, or one of which some bits have.
  void put(uint32_t address, uint32_t value, bool sure) {
    const bool maximum = address >= 0x0056 && address <= 0x005D;
    if (maximum || address == 0x0066 || address == 0x0067) unknown_ = true;
    if (address == 0x006A && value != kJerkLimited) unknown_ = true;
    if (address == 0x0042 && (value == kHoming || !sure)) unknown_ = true;
    if (address == 0x0014 && (value == kDefaults || !sure)) unknown_ = true;
    const bool wide = (address >= 0x0062 && address <= 0x006A) || (address >= 0x0074 && address <= 0x0077);
    if (wide && !sure) unknown_ = true;
  }

  // The whole of a 32-bit value that has been written.
  void put_wide(uint32_t address, uint32_t value) {
    const bool of_profile = address == 0x0062 || address == 0x0064 || address == 0x0068;
    if (of_profile && value > kQuickStop) unknown_ = true;
    if (address == 0x0074) low_ = static_cast<int32_t>(value);
    if (address == 0x0076) high_ = static_cast<int32_t>(value);
  }

  bool left(int64_t from, int64_t to) const {
    if (unknown_ || low_ >= high_) return false;
    return (to > from && to > high_ * kCount + kRounding) || (to < from && to < low_ * kCount - kRounding);
  }

 private:
  static constexpr uint32_t kHoming = 6;
  static constexpr uint32_t kDefaults = 0x4C44;
  static constexpr uint32_t kJerkLimited = 3;
  static constexpr uint32_t kQuickStop = 100000000;  // its deceleration as delivered, and its jerk's register
  static constexpr int64_t kCount = int64_t{1} << 32;
  static constexpr int64_t kRounding = 8192;  // the plan's 1e-6 counts, the shaper's stages, and as much again

  bool unknown_ = false;
  int64_t low_ = 0;
  int64_t high_ = 0;
};

}  // namespace stillpoint::testing
