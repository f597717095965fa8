// SPDX-License-Identifier: Apache-2.0
#include "firmware/modbus_rtu.hpp"

#include "firmware/crc16.hpp"

namespace stillpoint::firmware {

void RtuPort::begin(hal::ByteStream& line, uint8_t unit, uint32_t silence) {
  line_ = &line;
  unit_ = unit;
  silence_ = silence;
}

bool RtuPort::poll(uint32_t now_ticks) {
  send();
  receive(now_ticks);
  if (length_ == 0 || sending() || now_ticks - last_byte_ticks_ < silence_) return false;
  if (accept()) return true;
  length_ = 0;
  too_long_ = false;
  return false;
}

void RtuPort::send() {
  while (sending() && line_->write(answer_[sent_])) ++sent_;
}

void RtuPort::receive(uint32_t now_ticks) {
  uint8_t byte = 0;
  for (uint32_t i = 0; i < kBytesPerPoll && line_->read(byte); ++i) {
    last_byte_ticks_ = now_ticks;
    if (length_ < kMaxFrameBytes) {
      received_[length_++] = byte;
    } else {
      too_long_ = true;
    }
  }
}

bool RtuPort::accept() {
  if (too_long_) {
    ++counters_.oversize;
    return false;
  }
  if (length_ < kMinFrameBytes) {
    ++counters_.runts;
    return false;
  }
  // Over the frame with its own CRC, low byte first, the remainder is zero.
  if (crc16(received_, length_) != 0) {
    ++counters_.crc_errors;
    return false;
  }
  if (received_[0] != unit_ && received_[0] != kBroadcastUnit) {
    ++counters_.others;
    return false;
  }
  ++counters_.requests;
  return true;
}

void RtuPort::reply(size_t response_length) {
  const bool answered = !broadcast() && response_length > 0 && response_length <= kMaxPduBytes;
  const bool refused = response_length > 0 && (answer_[1] & modbus::kExceptionBit) != 0;
  length_ = 0;
  if (refused) ++counters_.exceptions;
  if (!answered) {
    ++counters_.unanswered;
    return;
  }
  if (refused && answer_[2] == static_cast<uint8_t>(ModbusException::kDeviceBusy)) ++counters_.busy;
  answer_[0] = unit_;
  const size_t body = 1 + response_length;
  const uint16_t crc = crc16(answer_, body);
  answer_[body] = static_cast<uint8_t>(crc);
  answer_[body + 1] = static_cast<uint8_t>(crc >> 8);
  sent_ = 0;
  answer_length_ = body + 2;
  send();
}

}  // namespace stillpoint::firmware
