// SPDX-License-Identifier: Apache-2.0
// expect: nodiscard
#include "shaper/base/ring_buffer.hpp"

bool push(stillpoint::RingBuffer<int, 4>& buffer);

bool push(stillpoint::RingBuffer<int, 4>& buffer) {
#ifdef MUST_NOT_COMPILE
  buffer.push(1);
#endif
  return buffer.push(1);
}
