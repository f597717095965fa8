// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace stillpoint::testing {

// Modbus RTU's, bit by bit, from the specification; not the product's. 0 over a whole frame, its own CRC included.
inline uint16_t reference_crc(const uint8_t* bytes, size_t count) {
  uint32_t crc = 0xFFFF;
  for (size_t i = 0; i < count; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? (crc >> 1) ^ 0xA001 : crc >> 1;
  }
  return static_cast<uint16_t>(crc);
}

}  // namespace stillpoint::testing
