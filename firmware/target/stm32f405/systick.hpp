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

}  // namespace stillpoint::stm32f405
