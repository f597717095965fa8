// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillpoint::stm32f405 {

// What is wired where (alternate functions: datasheet DS8626, table 9):
//   PA2  USART2 TX, PA3  USART2 RX   servo link
//   PA9  USART1 TX, PA10 USART1 RX   Modbus client
//   PC6  enable line of the drive: high while it may hold torque. A resistor must hold it low while the chip is in
//   reset.
void set_up_pins();

// Any context, faults included: one store.
void set_enable_line(bool high);

}  // namespace stillpoint::stm32f405
