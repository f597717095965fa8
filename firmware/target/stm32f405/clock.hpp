// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

namespace stillpoint::stm32f405 {

enum class ClockSource : uint8_t {
  kCrystalPll,   // 8 MHz crystal times the PLL: 168 MHz
  kInternalPll,  // the crystal did not start: internal oscillator (16 MHz, 1 %) times the PLL: 168 MHz
  kInternal,     // the PLL did not lock either: 16 MHz
  kUnanswered,   // the clock controller says nothing at all, not even that the oscillator this code runs from is ready
};

struct Clock {
  ClockSource source;
  uint32_t core_hz;
  uint32_t apb1_hz;  // USART2
  uint32_t apb2_hz;  // USART1
};

// Brings the chip to its full speed if it will go there, and says what came of it. Once, right after reset. Every wait
// is bounded by 25 ms at 16 MHz, and there are at most seven.
// kUnanswered is what an emulator without a clock controller gives (QEMU 7.2's netduinoplus2: every register reads 0);
// silicon cannot, since HSIRDY is set before the first instruction. Full speed is assumed then.
// Not run on silicon yet.
Clock start_clock();

}  // namespace stillpoint::stm32f405
