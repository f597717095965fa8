// SPDX-License-Identifier: Apache-2.0
// expect: a ring buffer holds at least one element
#include "shaper/base/ring_buffer.hpp"

#ifdef MUST_NOT_COMPILE
stillpoint::RingBuffer<int, 0> buffer;
#else
stillpoint::RingBuffer<int, 1> buffer;
#endif
