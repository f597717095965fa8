// SPDX-License-Identifier: Apache-2.0
// A client line filled to 921,600 baud with requests, good and bad, none of which may disturb a motion. The shortest
// pause that ends a frame stands between most of them, none between some.
#pragma once

#include <algorithm>

#include "firmware/line_settings.hpp"
#include "tests/firmware/rig.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

class Flood {
 public:
  explicit Flood(uint64_t seed) : random_(seed) {}

  // What the line carries in the next tick.
  Bytes next() {
    if (pause_ != 0) {
      --pause_;
      return {};
    }
    while (at_ == frame_.size()) begin_frame();
    const size_t end = std::min(frame_.size(), at_ + kBytesPerTick);
    Bytes bytes(frame_.begin() + static_cast<std::ptrdiff_t>(at_), frame_.begin() + static_cast<std::ptrdiff_t>(end));
    at_ = end;
    if (at_ == frame_.size() && random_.integer(0, 9) != 0) pause_ = firmware::frame_silence_ms(115200);
    return bytes;
  }

  uint32_t frames() const { return frames_; }

 private:
  static constexpr size_t kBytesPerTick = 83;  // of 11 bits

  void begin_frame() {
    at_ = 0;
    ++frames_;
    const auto junk = static_cast<uint8_t>(random_.integer(0, 255));
    switch (random_.integer(0, 11)) {
      case 0: frame_ = framed({1, 3, 0x01, 0x00, 0, 34}); break;
      case 1: frame_ = framed({1, 3, 0x00, 0x40, 0, 16}); break;
      case 2: frame_ = framed({1, 16, 0x00, 0x44, 0, 2, 4, 0, junk, junk, junk}); break;      // a target, not started
      case 3: frame_ = framed({1, 16, 0x00, 0x60, 0, 2, 4, 0, 1, junk, junk}); break;         // of the next move
      case 4: frame_ = framed({1, 16, 0x00, 0x58, 0, 2, 4, 0, 0, junk, 1}); break;            // locked
      case 5: frame_ = framed({1, junk, 0xFF, 0xFF, 0, 1}); break;                            // exceptions
      case 6: frame_ = framed({0, 6, 0x00, 0x40, 0, 0x1F}); break;                            // all cannot be started
      case 7: frame_ = framed({static_cast<uint8_t>(junk | 2), 6, 0x00, 0x40, 0, 0}); break;  // another unit's
      case 8:
        frame_ = framed({1, 6, 0x00, 0x40, 0, 0});  // would end the move, but for its CRC
        frame_.back() = static_cast<uint8_t>(frame_.back() ^ (junk | 1));
        break;
      case 9: frame_ = {1, 6}; break;
      default:
        frame_.assign(static_cast<size_t>(random_.integer(1, 600)), 0);
        for (uint8_t& byte : frame_) byte = static_cast<uint8_t>(random_.integer(0, 255));
    }
  }

  Random random_;
  Bytes frame_;
  size_t at_ = 0;
  uint32_t pause_ = 0;
  uint32_t frames_ = 0;
};

}  // namespace stillpoint::testing
