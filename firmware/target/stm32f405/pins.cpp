// SPDX-License-Identifier: Apache-2.0
#include "firmware/target/stm32f405/pins.hpp"

namespace stillpoint::stm32f405 {
namespace {

constexpr uint32_t kModeOutput = 1, kModeAlternate = 2;
constexpr uint32_t kFastSlew = 2;
constexpr uint32_t kPullUp = 1;
constexpr uint32_t kTimerFunction = 1;  // of TIM1 and TIM2
constexpr uint32_t kUsartFunction = 7;

// A field of `bits` per pin, in one register.
void set_field(Register& reg, uint32_t bits, uint32_t pin, uint32_t value) {
  const uint32_t shift = pin * bits;
  const uint32_t mask = (1u << bits) - 1u;
  reg = (reg & ~(mask << shift)) | value << shift;
}

void set_up_pin(Gpio& port, uint32_t pin, uint32_t function) {
  set_field(port.AFR[pin / 8], 4, pin % 8, function);
  set_field(port.OSPEEDR, 2, pin, kFastSlew);
  set_field(port.PUPDR, 2, pin, kPullUp);  // a cable that is not there reads idle
  set_field(port.MODER, 2, pin, kModeAlternate);
}

}  // namespace

void set_up_pins() {
  rcc().AHB1ENR = rcc().AHB1ENR | Rcc::kAhb1GpioA | Rcc::kAhb1GpioC;
  set_enable_line(false);
  set_field(gpio_c().MODER, 2, kEnablePin, kModeOutput);
  set_pin(gpio_a(), kDrivePin, false);
  set_field(gpio_a().MODER, 2, kDrivePin, kModeOutput);
  static constexpr uint32_t kUsartPins[] = {2, 3, 9, 10};
  for (const uint32_t pin : kUsartPins) set_up_pin(gpio_a(), pin, kUsartFunction);
}

void set_up_pulse_pins() {
  set_pin(gpio_c(), kDirectionPin, false);
  set_field(gpio_c().MODER, 2, kDirectionPin, kModeOutput);
  static constexpr uint32_t kTimerPins[] = {0, 1, 8};
  for (const uint32_t pin : kTimerPins) set_up_pin(gpio_a(), pin, kTimerFunction);
}

void set_enable_line(bool high) { set_pin(gpio_c(), kEnablePin, high); }

}  // namespace stillpoint::stm32f405
