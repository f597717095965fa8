// SPDX-License-Identifier: Apache-2.0
// Instructions a tick on the emulated Cortex-M4, run under -icount shift=0: one instruction is then one nanosecond of
// virtual time, which TIM2 counts at its emulated 1 GHz. Exact and repeatable; instructions, not cycles: no flash wait
// states, no pipeline.
#include "firmware/target/stm32f405/registers.hpp"
#include "tests/bench/scenarios.hpp"
#include "tests/support/test.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;
using stillpoint::testing::print;
using stillpoint::testing::value_of;

// RM0090 18.4
struct Timer {
  volatile uint32_t CR1, CR2, SMCR, DIER, SR, EGR, CCMR1, CCMR2, CCER, CNT, PSC, ARR;
};
Timer& timer() { return *reinterpret_cast<Timer*>(0x40000000); }

uint32_t instructions_now() { return timer().CNT; }

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
  uint32_t mean() const { return (total_ + ticks_ / 2) / ticks_; }
  uint32_t most() const { return most_; }

 private:
  uint32_t ticks_ = 0;
  uint32_t least_ = 0;
  uint32_t most_ = 0;
  uint32_t total_ = 0;
};

void print_right(uint32_t value, int width) {
  for (uint32_t limit = 10; width > 1; --width, limit *= 10) {
    if (value < limit) print(" ");
  }
  print(value_of(value));
}

void print_left(const char* text, int width) {
  print(text);
  for (; *text != '\0'; ++text) --width;
  for (; width > 0; --width) print(" ");
}

void print_row(const char* name, const Count& count) {
  print_left(name, 16);
  print_right(count.least(), 8);
  print_right(count.mean(), 8);
  print_right(count.most(), 8);
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

Axis<kCapacity> axis;
Shaper shaper;
LineSample memory[kCapacity];

// `tick` of a cascade of `stages` times `taps`; long enough for every line to wrap at a time of its own.
struct Stages : Counting {
  uint32_t most(uint32_t stages, uint32_t taps) {
    TEST_ASSERT_OK(shaper.configure(cascade_of(stages, taps), memory, kCapacity, 0));
    Count count;
    Signal input = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      input += INT64_C(123456789012);
      measure(count, [&] { static_cast<void>(shaper.tick(input)); });
    }
    return count.most();
  }
};

TEST_F(Counting, a_loop_of_known_length_counts_true) {
  for (uint32_t turns = 10; turns <= 100000; turns *= 10) {
    Count count;
    measure(count, [turns] {
      uint32_t left = turns;
      __asm__ volatile("1: subs %0, #1\n bne 1b" : "+r"(left) : : "cc");
    });
    TEST_INFO(turns, turns);
    TEST_ASSERT_AT_LEAST_INT64(2 * turns, count.least());
    TEST_ASSERT_AT_MOST_INT64(2 * turns + 5, count.least());
  }
}

TEST_F(Stages, a_stage_of_three_taps_takes_at_most_60) {
  const uint32_t none = most(0, 1);
  const uint32_t three = most(1, 3), five = most(1, 5), seven = most(1, 7);
  const uint32_t two_of_three = most(2, 3);
  const uint32_t stage = two_of_three - three;
  const uint32_t tap = (seven - three + 2) / 4;

  print("\ninstructions of Shaper::tick, most of 1000 ticks\n");
  print_left("no stage", 32), print_right(none, 8), print("\n");
  print_left("one of 3 taps", 32), print_right(three, 8), print("\n");
  print_left("one of 5 taps", 32), print_right(five, 8), print("\n");
  print_left("one of 7 taps", 32), print_right(seven, 8), print("\n");
  print_left("two of 3 taps", 32), print_right(two_of_three, 8), print("\n");
  print_left("a further 3-tap stage", 32), print_right(stage, 8), print("   (budget 60)\n");
  print_left("  of it fixed", 32), print_right(stage - 3 * tap, 8), print("\n");
  print_left("  of it a tap", 32), print_right(tap, 8), print("\n");

  TEST_ASSERT_AT_MOST_INT64(60, stage);
  TEST_ASSERT_AT_LEAST_INT64(20, stage);  // less is not a 64-bit stage: the count is wrong
}

TEST_F(Counting, the_reference_move_is_counted) {
  TEST_ASSERT_OK(axis.configure(kAxis));
  print("\ninstructions of Axis::tick over the reference move\n");
  print_left("shaper", 16), print("   least    mean    most\n");
  bool forth = true;
  for (const Scenario& scenario : kScenarios) {
    ShaperDesign design{};
    TEST_ASSERT_OK(design_of(scenario, design));
    TEST_ASSERT_OK(axis.set_shaper(design));
    static_cast<void>(axis.tick());
    TEST_ASSERT_OK(axis.command(forth ? kMove : kMoveBack, nullptr));
    forth = !forth;
    Count count;
    do {
      measure(count, [] { static_cast<void>(axis.tick()); });
    } while (axis.state().phase != AxisPhase::kAtRest);
    print_row(scenario.name, count);
  }
}

// From the mode's ZV to its ZVD in a cruise, and the searches for it: one that finds room at once, one that finds none.
TEST_F(Counting, a_blend_is_counted) {
  TEST_ASSERT_OK(axis.configure(kAxis));
  print("\ninstructions of a blend from ZV to ZVD\n");
  print_left("", 16), print("   least    mean    most\n");
  Count search, fruitless, ticks;
  for (int pass = 0; pass < 2; ++pass) {
    ShaperDesign from{}, to{};
    TEST_ASSERT_OK(design_of(kScenarios[pass == 0 ? 1 : 2], from));
    TEST_ASSERT_OK(design_of(kScenarios[pass == 0 ? 2 : 1], to));
    TEST_ASSERT_OK(axis.set_shaper(from));
    static_cast<void>(axis.tick());
    Move move = axis.state().setpoint == 0 ? kMove : kMoveBack;
    move.duration_s = pass == 0 ? 4.0 : 0.0;
    TEST_ASSERT_OK(axis.command(move, nullptr));
    for (int tick = 0; tick < 300; ++tick) static_cast<void>(axis.tick());
    measure(pass == 0 ? search : fruitless, [&] { TEST_ASSERT_OK(axis.set_shaper(to, Retune::kBlended)); });
    while (pass == 0 && axis.pending()) measure(ticks, [] { static_cast<void>(axis.tick()); });
    while (axis.state().phase != AxisPhase::kAtRest) static_cast<void>(axis.tick());
    static_cast<void>(axis.tick());
  }
  print_row("Axis::tick", ticks);
  print_row("search", search);
  print_row("no room", fruitless);
}

}  // namespace
