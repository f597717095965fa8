// SPDX-License-Identifier: Apache-2.0
// Instructions on the emulated Cortex-M4, run under -icount shift=0: one instruction is then one nanosecond of virtual
// time, which TIM2 counts at its emulated 1 GHz. Exact and repeatable; instructions, not cycles: no flash wait states,
// no pipeline.
#pragma once

#include "firmware/target/stm32f405/registers.hpp"
#include "tests/support/table.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::bench {

using testing::print;
using testing::print_left;
using testing::print_right;
using testing::value_of;

// RM0090 18.4
struct Timer {
  volatile uint32_t CR1, CR2, SMCR, DIER, SR, EGR, CCMR1, CCMR2, CCER, CNT, PSC, ARR;
};
inline Timer& timer() { return *reinterpret_cast<Timer*>(0x40000000); }

inline uint32_t instructions_now() { return timer().CNT; }

// Least, mean and most of what was counted, less what counting itself takes.
class Count {
 public:
  void add(uint32_t instructions) {
    if (ticks_ == 0 || instructions < least_) least_ = instructions;
    if (instructions > most_) most_ = instructions;
    total_ += instructions;
    ++ticks_;
  }
  uint32_t least() const { return least_; }
  uint32_t mean() const { return static_cast<uint32_t>((total_ + ticks_ / 2) / ticks_); }
  uint32_t most() const { return most_; }

 private:
  uint32_t ticks_ = 0;
  uint32_t least_ = 0;
  uint32_t most_ = 0;
  uint64_t total_ = 0;
};

inline void print_row(const char* name, const Count& count) {
  print_left(name, 16);
  print_right(count.least(), 10);
  print_right(count.mean(), 10);
  print_right(count.most(), 10);
  print("\n");
}

struct Counting {
  uint32_t overhead = 0;

  Counting() {
    timer().PSC = 0;
    timer().ARR = 0xFFFFFFFF;
    timer().CR1 = 1;
    const uint32_t before = instructions_now();
    overhead = instructions_now() - before;
  }

  template <typename Work>
  void measure(Count& count, const Work& work) const {
    const uint32_t before = instructions_now();
    work();
    count.add(instructions_now() - before - overhead);
  }
};

}  // namespace stillpoint::bench
