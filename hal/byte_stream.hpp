// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

namespace stillpoint::hal {

// Bytes in and out of a serial line. Never waits. Background context.
class ByteStream {
 public:
  // False when nothing has come.
  virtual bool read(uint8_t& byte) = 0;
  // False when the line cannot take a byte now; try again.
  virtual bool write(uint8_t byte) = 0;

 protected:
  ~ByteStream() = default;
};

}  // namespace stillpoint::hal
