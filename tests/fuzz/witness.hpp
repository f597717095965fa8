// SPDX-License-Identifier: Apache-2.0
// Who asked for the motion? Reads the line beside the drive, with its own CRC and its own idea of a frame, and knows
// which requests could have been a reason to move. Wherever bytes in a row are a request with a good CRC to this drive
// alone, it counts as heard, whatever came before it and however the gaps were: the drive may have heard less, so what
// it does for no reason that is known here, it does for none.
#pragma once

#include <stdint.h>

#include <deque>
#include <vector>

namespace stillpoint::testing {

constexpr uint8_t kUnit = 1;
constexpr uint32_t kHearing = 40;  // ticks from the last byte of a request to what it sets off, answers included

class Witness {
 public:
  // A byte on its way to the drive.
  void sent(uint8_t byte) {
    if (byte == kUnit) windows_.emplace_back();
    for (Window& window : windows_) {
      window.bytes.push_back(byte);
      window.crc = next_crc(window.crc, byte);
      if (window.crc == 0) hear(window.bytes);
    }
    while (!windows_.empty() && windows_.front().bytes.size() >= kMostBytes) windows_.pop_front();
    quiet_ticks_ = 0;
  }

  // Once a tick, before it is asked. `read`: the drive has taken every byte that was sent. `standing_ticks`: the
  // setpoint has not changed for so long.
  void tick(bool on, bool read, uint32_t standing_ticks) {
    on_ = on;
    if (!read) quiet_ticks_ = 0;
    if (quiet_ticks_ < UINT32_MAX) ++quiet_ticks_;
    if (quiet_ticks_ <= kHearing) return;
    // What was asked of a drive that is off, it has forgotten. On the way it only forgets a set-point that is over.
    if (!on) set_point_ = velocity_ = stream_ = tuning_ = false;
    if (on) enable_ = false;
    if (standing_ticks > kLongStanding && !velocity_ && !stream_ && !tuning_) set_point_ = false;
  }

  bool may_switch_on() const { return enable_; }
  bool may_move() const { return set_point_ || velocity_ || tuning_; }

 private:
  static constexpr size_t kMostBytes = 256;
  static constexpr uint32_t kLongStanding = 500;

  struct Window {
    std::vector<uint8_t> bytes;
    uint32_t crc = 0xFFFF;
  };

  static uint32_t next_crc(uint32_t crc, uint8_t byte) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? (crc >> 1) ^ 0xA001 : crc >> 1;
    return crc;
  }

  static uint32_t word(const std::vector<uint8_t>& frame, size_t at) {
    return uint32_t{frame[at]} << 8 | frame[at + 1];
  }

  void hear(const std::vector<uint8_t>& frame) {
    const size_t size = frame.size();
    if (size < 8) return;
    switch (frame[1]) {
      case 6: return hear_write(word(frame, 2), word(frame, 4));
      case 16: return hear_words(frame, 2, 7);
      case 22: return hear_write(word(frame, 2), 0xFFFF);  // some bits of it
      case 23: return size > 11 ? hear_words(frame, 6, 11) : void();
      default: return;
    }
  }

  void hear_words(const std::vector<uint8_t>& frame, size_t address_at, size_t words_at) {
    for (size_t at = words_at; at + 3 < frame.size(); at += 2) {
      hear_write(word(frame, address_at) + static_cast<uint32_t>(at - words_at) / 2, word(frame, at));
    }
  }

  void hear_write(uint32_t address, uint32_t value) {
    // An edge before operation is enabled is lost, also in the request that enables.
    if (address == 0x0040 && (value & 0x10) != 0 && (on_ || enable_)) set_point_ = true;
    if (address == 0x0040 && (value & 0x0F) == 0x0F) enable_ = true;
    if (address == 0x0052 || address == 0x0053) velocity_ = true;
    if (address >= 0x0090 && address <= 0x00CF) stream_ = true;  // goes on a motion, and begins none
    if (address == 0x0200) tuning_ = true;
  }

  std::deque<Window> windows_;
  uint32_t quiet_ticks_ = 0;
  bool on_ = false;
  bool enable_ = false;
  bool set_point_ = false;
  bool velocity_ = false;
  bool stream_ = false;
  bool tuning_ = false;
};

}  // namespace stillpoint::testing
