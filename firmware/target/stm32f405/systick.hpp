// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware/target/stm32f405/registers.hpp"

namespace stillpoint::stm32f405 {

// The chip's own millisecond, at the tick's priority.
inline void start_systick(uint32_t core_hz) {
  scb().SHPR[2] = static_cast<uint32_t>(Priority::kTick) << 24;
  systick().LOAD = core_hz / 1000 - 1;
  systick().VAL = 0;
  systick().CTRL = SysTick::kCtrlOn | SysTick::kCtrlInterrupt | SysTick::kCtrlProcessorClock;
}

// Whether what ran since it was made, at the tick's priority, took a millisecond or more: SysTick has then come round
// to where it was, and could not be served. Up to two milliseconds; what began with it pending is not judged.
class Overrun {
 public:
  Overrun() : pending_(is_pending()), at_(systick().VAL) {}
  bool happened() const { return !pending_ && is_pending() && systick().VAL <= at_; }

 private:
  static bool is_pending() { return (scb().ICSR & Scb::kIcsrSysTickPending) != 0; }

  bool pending_;
  uint32_t at_;
};

}  // namespace stillpoint::stm32f405
