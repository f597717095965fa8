// SPDX-License-Identifier: Apache-2.0
// CRC-32 (IEEE 802.3): reflected polynomial EDB88320h, initial and final value FFFFFFFFh. Check value of "123456789":
// CBF43926h. Used by the stored parameters.
#pragma once

#include <stdint.h>

namespace stillpoint::firmware {

constexpr uint32_t kCrc32Initial = 0xFFFFFFFF;

inline constexpr uint32_t kCrc32OfNibble[16] = {0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4,
                                                0x4DB26158, 0x5005713C, 0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C,
                                                0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C};

// Adds a word, low byte first; the state is complemented at the end. Any context.
constexpr uint32_t crc32_update(uint32_t crc, uint32_t word) {
  crc ^= word;
  for (int nibble = 0; nibble < 8; ++nibble) crc = (crc >> 4) ^ kCrc32OfNibble[crc & 0xFU];
  return crc;
}

}  // namespace stillpoint::firmware
