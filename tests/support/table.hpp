// SPDX-License-Identifier: Apache-2.0
// Columns for what a chip test prints.
#pragma once

#include "tests/support/test.hpp"

namespace stillpoint::testing {

inline void print_right(uint32_t value, int width) {
  uint32_t limit = 10;
  for (; width > 1; --width) {
    if (value < limit) print(" ");
    limit = limit > UINT32_MAX / 10 ? UINT32_MAX : limit * 10;
  }
  print(value_of(value));
}

inline void print_left(const char* text, int width) {
  print(text);
  for (; *text != '\0'; ++text) --width;
  for (; width > 0; --width) print(" ");
}

}  // namespace stillpoint::testing
