// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

// From linker.ld; the address is the value.
extern "C" uint32_t stack_end[];

namespace stillpoint::stm32f405 {

// A few words at the far end of the stack that nothing else writes: what overwrites them has gone too deep. It is seen
// after the fact, and only where the frame that went too deep wrote to them.
class StackGuard {
 public:
  static void lay() {
    volatile uint32_t* const words = stack_end;
    for (uint32_t i = 0; i < kWords; ++i) words[i] = kPattern ^ i;
  }

  // Any context.
  static bool intact() {
    const volatile uint32_t* const words = stack_end;
    for (uint32_t i = 0; i < kWords; ++i) {
      if (words[i] != (kPattern ^ i)) return false;
    }
    return true;
  }

 private:
  static constexpr uint32_t kWords = 8;
  static constexpr uint32_t kPattern = 0x5AFE57AC;
};

}  // namespace stillpoint::stm32f405
