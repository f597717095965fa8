// SPDX-License-Identifier: Apache-2.0
// From reset to main: vector table, memory, FPU. Shared by the firmware and by the test images, which replace the
// handlers they need and define main.
#include <stddef.h>
#include <stdint.h>

#include "firmware/target/stm32f405/registers.hpp"

using namespace stillpoint::stm32f405;

extern "C" {

// From linker.ld; the addresses are the values.
extern uint32_t stack_top, data_begin, data_end, data_load, bss_begin, bss_end;

// `int main()` of the image. Under another name here: ISO C++ forbids calling ::main.
void image_main() __asm__("main");

// What an image may do before the chip waits for its watchdog: switch outputs off. Must not use the stack's contents
// or anything else that may be broken.
void safe_state() __attribute__((weak));
void safe_state() {}

void fault_handler();
void fault_handler() {
  __asm__ volatile("cpsid i" ::: "memory");
  safe_state();
  for (;;) {  // until the watchdog bites
  }
}

void systick_handler() __attribute__((weak, alias("fault_handler")));
void usart1_handler() __attribute__((weak, alias("fault_handler")));
void usart2_handler() __attribute__((weak, alias("fault_handler")));

[[noreturn]] void reset_handler();
void reset_handler() {
  // First of all, since compiled code may use it. Lazy stacking of its registers is on after reset (FPCCR).
  scb().CPACR = scb().CPACR | Scb::kCpacrFpu;
  __asm__ volatile("dsb\n isb" ::: "memory");
  uint32_t* from = &data_load;
  for (uint32_t* to = &data_begin; to < &data_end;) *to++ = *from++;
  for (uint32_t* to = &bss_begin; to < &bss_end;) *to++ = 0;
  scb().SHCSR = scb().SHCSR | Scb::kShcsrFaultsOn;
  image_main();
  for (;;) fault_handler();
}

}  // extern "C"

namespace {

using Handler = void (*)();

struct VectorTable {
  const void* initial_stack;
  Handler system[15];
  Handler interrupts[kInterruptCount];
};

constexpr size_t kSysTick = 14;  // of `system`: exception 15

constexpr VectorTable vector_table() {
  VectorTable table{&stack_top, {}, {}};
  for (Handler& handler : table.system) handler = fault_handler;
  for (Handler& handler : table.interrupts) handler = fault_handler;
  table.system[0] = reset_handler;
  table.system[kSysTick] = systick_handler;
  table.interrupts[static_cast<uint32_t>(Interrupt::kUsart1)] = usart1_handler;
  table.interrupts[static_cast<uint32_t>(Interrupt::kUsart2)] = usart2_handler;
  return table;
}

__attribute__((section(".vectors"), used)) constexpr VectorTable kVectorTable = vector_table();

}  // namespace
