// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "firmware/target/stm32f405/registers.hpp"

namespace stillpoint::stm32f405 {

// What is wired where (alternate functions: datasheet DS8626, table 9):
//   PA2  USART2 TX, PA3  USART2 RX   servo link
//   PA9  USART1 TX, PA10 USART1 RX   Modbus client
//   PA12 high while the client is answered: DE and not-RE of an RS-485 transceiver
//   PC6  enable line of the drive: high while it may hold torque. A resistor must hold it low while the chip is in
//   reset.
// On a board with a pulse port besides (set_up_pulse_pins), not run on silicon yet:
//   PA8  TIM1 CH1                    pulse
//   PC7  direction, high forward
//   PA0  TIM2 CH1, PA1 TIM2 CH2      encoder, A and B
void set_up_pins();
void set_up_pulse_pins();

// Of port A.
constexpr uint32_t kDrivePin = 12;
// Of port C.
constexpr uint32_t kEnablePin = 6;
constexpr uint32_t kDirectionPin = 7;

// Any context: one store.
inline void set_pin(Gpio& port, uint32_t pin, bool high) { port.BSRR = 1u << (high ? pin : pin + 16); }

// Any context, faults included: one store.
void set_enable_line(bool high);

}  // namespace stillpoint::stm32f405
