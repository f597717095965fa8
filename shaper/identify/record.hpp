// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

namespace stillpoint {

// Residual vibration, sampled evenly: any unit, any offset. Single precision: a record is the large thing in
// memory, and no sensor has 24 bits. Take a large offset (an absolute encoder) off before narrowing.
struct Record {
  const float* samples;
  size_t count;

  Record part(size_t first, size_t end) const { return {samples + first, end - first}; }
};

}  // namespace stillpoint
