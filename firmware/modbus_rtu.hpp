// SPDX-License-Identifier: Apache-2.0
// Modbus RTU framing, slave side: frames end by silence, unit, CRC.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "firmware/modbus_pdu.hpp"
#include "hal/byte_stream.hpp"

namespace stillpoint::firmware {

constexpr uint8_t kBroadcastUnit = 0;

// Only go up, and wrap.
struct RtuCounters {
  uint32_t requests;  // whole, for this unit or for all
  uint32_t others;    // whole, for another unit
  uint32_t crc_errors;
  uint32_t runts;       // too short to be a frame
  uint32_t oversize;    // longer than a frame can be
  uint32_t exceptions;  // answers that refuse, also to broadcasts, which do not get them
  uint32_t busy;        // those with exception 06 that were sent
  uint32_t unanswered;  // requests without an answer: broadcasts, and what is only listened to
};

// Background. Zero-initialised storage is valid. Takes and gives bytes as the line offers, never waits. Everything that
// is not a whole frame for this unit is dropped in silence and counted.
class RtuPort {
 public:
  static constexpr size_t kMaxFrameBytes = 256;

  // `silence`: steps of the clock below, without a byte, that end a frame (frame_silence_ms).
  void begin(hal::ByteStream& line, uint8_t unit, uint32_t silence);

  // True when a request is complete; it stays until `reply`. `now_ticks` may wrap. Not complete while an answer is
  // still going out.
  bool poll(uint32_t now_ticks);

  // The request's PDU (at least one byte), and room for kMaxPduBytes of the response's.
  const uint8_t* request() const { return received_ + 1; }
  size_t request_length() const { return length_ - kEnvelopeBytes; }
  uint8_t* response() { return answer_ + 1; }

  // The request is for all units.
  bool broadcast() const { return received_[0] == kBroadcastUnit; }

  // Ends the request and sends the response; a broadcast is not answered, and one of no bytes is none.
  void reply(size_t response_length);

  bool sending() const { return sent_ < answer_length_; }
  const RtuCounters& counters() const { return counters_; }

 private:
  static constexpr size_t kEnvelopeBytes = 3;  // unit and CRC
  static constexpr size_t kMinFrameBytes = kEnvelopeBytes + 1;
  static constexpr uint32_t kBytesPerPoll = 64;

  void send();
  void receive(uint32_t now_ticks);
  bool accept();

  hal::ByteStream* line_ = nullptr;
  uint8_t unit_ = 0;
  uint32_t silence_ = 0;
  bool too_long_ = false;
  uint32_t last_byte_ticks_ = 0;
  size_t length_ = 0;
  size_t answer_length_ = 0;
  size_t sent_ = 0;
  RtuCounters counters_ = {};
  uint8_t received_[kMaxFrameBytes] = {};
  uint8_t answer_[kMaxFrameBytes] = {};
};

}  // namespace stillpoint::firmware
