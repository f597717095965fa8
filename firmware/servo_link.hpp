// SPDX-License-Identifier: Apache-2.0
// The framed protocol between the servo drive and this firmware: one sync a tick one way, one reply the other way.
// All fields little-endian, no padding.
//
//   sync   (drive to firmware, 18 bytes): A5, flags (bit 0 position valid, bit 1 commit), sequence u16,
//                                         position i64 (counts * 2^32), tip acceleration i32 (raw), CRC-16
//   reply  (firmware to drive, 14 bytes): 5A, flags (bit 0 enabled), sequence u16 of the sync answered,
//                                         setpoint i64 (counts * 2^32), CRC-16
//
// CRC-16 is Modbus's, over everything before it, low byte first. Flag bits not named are sent 0 and ignored. A receiver
// drops a frame whose CRC is wrong, so a broken sync shows as a gap in the sequence. At the 2 Mbaud of the STM32F405
// port a sync takes 90 us and a reply 70 us of the tick.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "hal/servo_port.hpp"

namespace stillpoint::servo_link {

constexpr size_t kSyncBytes = 18;
constexpr size_t kReplyBytes = 14;
constexpr uint8_t kSyncHeader = 0xA5;
constexpr uint8_t kReplyHeader = 0x5A;

struct Reply {
  hal::ServoCommand command;
  uint16_t sequence;  // of the sync that it answers
};

// `to` has room for kSyncBytes.
void encode_sync(const hal::ServoFeedback& sync, uint8_t* to);

// `to` has room for kReplyBytes.
void encode_reply(const Reply& reply, uint8_t* to);

// `from` has kSyncBytes. False, and `sync` untouched, when the header or the CRC is wrong.
[[nodiscard]] bool decode_sync(const uint8_t* from, hal::ServoFeedback& sync);

// `from` has kReplyBytes. False, and `reply` untouched, when the header or the CRC is wrong.
[[nodiscard]] bool decode_reply(const uint8_t* from, Reply& reply);

// Finds frames in a stream of bytes, one byte at a time; a zero-initialised reader is ready. After garbage, or when a
// byte was lost, the bytes of the broken frame are searched for the header of the next one, so no whole frame is lost
// after it. Cost: at most one CRC and one move of a frame a byte. `Frame` says what a frame is.
template <typename Frame>
class Reader {
 public:
  // True when `byte` ends a frame; `frame` then holds it, untouched otherwise.
  [[nodiscard]] bool push(uint8_t byte, typename Frame::Content& frame) {
    if (count_ == 0 && byte != Frame::kHeader) {
      ++bytes_dropped_;
      return false;
    }
    bytes_[count_++] = byte;
    if (count_ < Frame::kBytes) return false;
    if (Frame::decode(bytes_, frame)) {
      count_ = 0;
      return true;
    }
    drop_to_next_header();
    return false;
  }

  // Bytes that belonged to no frame; only goes up, wraps.
  uint32_t bytes_dropped() const { return bytes_dropped_; }

 private:
  void drop_to_next_header() {
    size_t from = 1;
    while (from < count_ && bytes_[from] != Frame::kHeader) ++from;
    bytes_dropped_ += static_cast<uint32_t>(from);
    count_ -= from;
    for (size_t i = 0; i < count_; ++i) bytes_[i] = bytes_[i + from];
  }

  uint8_t bytes_[Frame::kBytes] = {};
  size_t count_ = 0;
  uint32_t bytes_dropped_ = 0;
};

struct SyncFrame {
  using Content = hal::ServoFeedback;
  static constexpr size_t kBytes = kSyncBytes;
  static constexpr uint8_t kHeader = kSyncHeader;
  static bool decode(const uint8_t* from, Content& sync) { return decode_sync(from, sync); }
};

struct ReplyFrame {
  using Content = Reply;
  static constexpr size_t kBytes = kReplyBytes;
  static constexpr uint8_t kHeader = kReplyHeader;
  static bool decode(const uint8_t* from, Content& reply) { return decode_reply(from, reply); }
};

using SyncReader = Reader<SyncFrame>;
using ReplyReader = Reader<ReplyFrame>;

}  // namespace stillpoint::servo_link
