// SPDX-License-Identifier: Apache-2.0
// Instructions, the gaps between calls of Meanwhile, and stack of what the background does.
#pragma once

#include "tests/bench/counting.hpp"

extern "C" uint32_t bss_end;  // linker.ld

namespace stillpoint::bench {

// Writes a pattern below the stack pointer and counts what of it has been written over since.
class Paint {
 public:
  [[gnu::noinline]] static void lay() {
    for (volatile uint32_t* word = &bss_end; word < here() - kOwnWords; ++word) *word = kPattern;
  }
  [[gnu::noinline]] static uint32_t bytes_used() {
    const volatile uint32_t* word = &bss_end;
    while (*word == kPattern) ++word;
    return static_cast<uint32_t>(here() - word) * 4;
  }

 private:
  static constexpr uint32_t kPattern = 0x5AFEC0DE;
  static constexpr int kOwnWords = 16;
  static volatile uint32_t* here() {
    uint32_t* pointer;
    __asm__ volatile("mov %0, sp" : "=r"(pointer));
    return pointer;
  }
};

// The design at work: what it took so far, the gaps between its calls of Meanwhile. The timer turns round every 4.3e9
// instructions; a gap never does.
struct Watch {
  uint32_t last = 0;
  uint32_t gap = 0;
  uint64_t total = 0;

  void look() {
    const uint32_t now = instructions_now();
    if (now - last > gap) gap = now - last;
    total += now - last;
    last = now;
  }
  static void look_at(void* watch) { static_cast<Watch*>(watch)->look(); }
};

}  // namespace stillpoint::bench
