// SPDX-License-Identifier: Apache-2.0
// A tiny image for bounded_tick_self_test.sh. As it stands the tick is bounded; each PLANT_... plants a violation that
// bounded_tick.py must find.
#include <stdint.h>

extern "C" {
extern uint32_t stack_top;
void reset_handler();
void usart2_handler();
[[gnu::noinline]] void* malloc(uint32_t bytes);
}

volatile int64_t number = 7;
volatile int32_t small = 7;
volatile double real = 7.0;
volatile float single = 7.0F;

struct Port {
  virtual void exchange() = 0;

 protected:
  ~Port() = default;
};

struct PlantedPort final : Port {
  void exchange() override {
#ifdef PLANT_DOUBLE
    real = real + 1.0;
#endif
    small = 1;
  }
};

[[gnu::noinline]] void deeper(int32_t left);
void deeper(int32_t left) {
  small = left;
#ifdef PLANT_RECURSION
  if (left > 0) deeper(left - 1);
  small = 0;
#endif
}

void* malloc(uint32_t) { return nullptr; }

namespace stillpoint {
struct AxisCore {
  int64_t tick(bool commit);
};

[[gnu::noinline]] int64_t AxisCore::tick(bool commit) {
#ifdef PLANT_DIVISION
  small = small / (commit ? 3 + small : 1);
#endif
#ifdef PLANT_LONG_DIVISION
  number = number / (number + 1);
#endif
#ifdef PLANT_FLOAT
  single = single * 2.0F;
#endif
#ifdef PLANT_HEAP
  number = malloc(4) == nullptr ? 1 : 0;
#endif
  deeper(commit ? 1 : 0);
  return number;
}
}  // namespace stillpoint

using Function = void (*)();
volatile Function somewhere;
#ifndef PLANT_POINTER
PlantedPort port;
Port* volatile use = &port;
#endif

void usart2_handler() {
#ifdef PLANT_POINTER
  somewhere();
#else
  Port* const chosen = use;
  chosen->exchange();
#endif
#ifndef PLANT_UNREACHED
  static_cast<void>(stillpoint::AxisCore().tick(true));
#endif
}

// The background may compute as it likes.
void reset_handler() {
  static_cast<void>(stillpoint::AxisCore().tick(true));
  real = real / 3.0;
  for (;;) number = number / 3;
}

__attribute__((section(".vectors"), used))
const Function kVectors[3] = {reinterpret_cast<Function>(&stack_top), reset_handler, usart2_handler};
