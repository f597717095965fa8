// SPDX-License-Identifier: Apache-2.0
// How the client's line is set (registers 0021, 0022).
#pragma once

#include <stdint.h>

namespace stillpoint::firmware {

// 0021 and 0022 hold the index and the format. Never renumbered.
constexpr uint32_t kBauds[] = {9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600};
constexpr uint32_t kBaudCount = sizeof kBauds / sizeof kBauds[0];
enum class LineFormat : uint16_t { k8N1, k8E1, k8O1, k8N2 };
constexpr uint32_t kLineFormats = 4;

struct LineSettings {
  uint32_t baud;
  LineFormat format;
};

// Silence that ends a frame, in steps of a clock of 1 ms that may be anywhere between two steps when the last byte
// comes: more than the 3.5 characters of 11 bits that the specification asks for up to 19200 baud, and than its 1.75 ms
// above (Modbus over serial line 1.02, 2.5.1.1). Gaps inside a frame are not minded below that: USB adapters make
// them.
constexpr uint32_t frame_silence_ms(uint32_t baud) { return baud > 19200 ? 3 : 38500 / baud + 2; }

}  // namespace stillpoint::firmware
