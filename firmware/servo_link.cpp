// SPDX-License-Identifier: Apache-2.0
#include "firmware/servo_link.hpp"

#include "firmware/crc16.hpp"

namespace stillpoint::servo_link {
namespace {

constexpr uint8_t kValid = 0x01;
constexpr uint8_t kCommit = 0x02;
constexpr uint8_t kEnabled = 0x01;

uint8_t* put(uint8_t* to, uint64_t value, size_t bytes) {
  for (size_t i = 0; i < bytes; ++i) to[i] = static_cast<uint8_t>(value >> (8 * i));
  return to + bytes;
}

uint64_t get(const uint8_t*& from, size_t bytes) {
  uint64_t value = 0;
  for (size_t i = 0; i < bytes; ++i) value |= uint64_t{from[i]} << (8 * i);
  from += bytes;
  return value;
}

void seal(uint8_t* frame, size_t bytes) { put(frame + bytes - 2, firmware::crc16(frame, bytes - 2), 2); }

bool intact(const uint8_t* frame, size_t bytes, uint8_t header) {
  const uint8_t* crc = frame + bytes - 2;
  return frame[0] == header && get(crc, 2) == firmware::crc16(frame, bytes - 2);
}

}  // namespace

void encode_sync(const hal::ServoFeedback& sync, uint8_t* to) {
  uint8_t* next = put(to, kSyncHeader, 1);
  next = put(next, (sync.valid ? kValid : 0u) | (sync.commit ? kCommit : 0u), 1);
  next = put(next, sync.sequence, 2);
  next = put(next, static_cast<uint64_t>(sync.position), 8);
  put(next, static_cast<uint32_t>(sync.acceleration), 4);
  seal(to, kSyncBytes);
}

void encode_reply(const Reply& reply, uint8_t* to) {
  uint8_t* next = put(to, kReplyHeader, 1);
  next = put(next, reply.command.enabled ? kEnabled : 0u, 1);
  next = put(next, reply.sequence, 2);
  put(next, static_cast<uint64_t>(reply.command.setpoint), 8);
  seal(to, kReplyBytes);
}

bool decode_sync(const uint8_t* from, hal::ServoFeedback& sync) {
  if (!intact(from, kSyncBytes, kSyncHeader)) return false;
  const uint8_t* next = from + 1;
  const uint64_t flags = get(next, 1);
  sync.valid = (flags & kValid) != 0;
  sync.commit = (flags & kCommit) != 0;
  sync.sequence = static_cast<uint16_t>(get(next, 2));
  sync.position = static_cast<int64_t>(get(next, 8));
  sync.acceleration = static_cast<int32_t>(static_cast<uint32_t>(get(next, 4)));
  return true;
}

bool decode_reply(const uint8_t* from, Reply& reply) {
  if (!intact(from, kReplyBytes, kReplyHeader)) return false;
  const uint8_t* next = from + 1;
  reply.command.enabled = (get(next, 1) & kEnabled) != 0;
  reply.sequence = static_cast<uint16_t>(get(next, 2));
  reply.command.setpoint = static_cast<int64_t>(get(next, 8));
  return true;
}

}  // namespace stillpoint::servo_link
