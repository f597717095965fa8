// SPDX-License-Identifier: Apache-2.0
// Instructions a tick. See counting.hpp.
#include "shaper/profile/stop_ramp.hpp"
#include "shaper/profile/stream_limiter.hpp"
#include "tests/bench/counting.hpp"
#include "tests/bench/scenarios.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;

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

// A CV shaper of h humps costs h + 1 ZV stages, not their 2^(h+1) impulses multiplied out.
uint32_t most_taps(const Scenario& scenario) {
  const bool convolved = scenario.kind >= ShaperKind::kCv1 && scenario.kind <= ShaperKind::kCv4;
  return convolved ? 3 * (humps_of(scenario.kind) + 1) * scenario.mode_count : ShaperDesign::kMaxTaps;
}

TEST_F(Counting, the_reference_move_is_counted) {
  TEST_ASSERT_OK(axis.configure(kAxis));
  print("\ninstructions of Axis::tick over the reference move\n");
  print_left("shaper", 16), print("     least      mean      most\n");
  bool forth = true;
  for (const Scenario& scenario : kScenarios) {
    ShaperDesign design{};
    TEST_ASSERT_OK(design_of(scenario, design));
    TEST_ASSERT_AT_MOST_INT64(most_taps(scenario), design.tap_count);
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
  print_left("", 16), print("     least      mean      most\n");
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

// A stream that passes, one that has to be caught up with after a step, and one that is nothing but noise.
TEST_F(Counting, a_limited_stream_is_counted) {
  StreamLimits limits{};
  TEST_ASSERT_OK(StreamLimits::make(kLimits, kTickS, limits));
  StreamLimiter limiter;
  Count passing, catching_up, noise;
  TEST_ASSERT_OK(axis.configure(kAxis));
  axis.reset(0);
  TEST_ASSERT_OK(axis.command(kMove, nullptr));
  limiter.start(limits, StreamPolicy::kClamp, 0, 0, 0, 0);
  do {
    const Signal input = axis.tick();
    measure(passing, [input, &limiter] { static_cast<void>(limiter.tick(input)); });
  } while (axis.state().phase != AxisPhase::kAtRest);
  TEST_ASSERT_EQUAL_UINT32(0, limiter.limited_ticks());
  do {
    measure(catching_up, [&limiter] { static_cast<void>(limiter.tick(0)); });
  } while (limiter.limiting());
  testing::Random random(1);
  for (int tick = 0; tick < 2000; ++tick) {
    const auto input = static_cast<Signal>(random.next()) >> (tick / 32);
    measure(noise, [input, &limiter] { static_cast<void>(limiter.tick(input)); });
  }
  axis.reset(0);
  print("\ninstructions of StreamLimiter::tick\n");
  print_left("", 16), print("     least      mean      most\n");
  print_row("passing", passing);
  print_row("catching up", catching_up);
  print_row("noise", noise);
}

// A quick stop from everywhere in the reference move, and one whose divisions are as long as can be.
TEST_F(Counting, a_stop_is_counted) {
  TEST_ASSERT_OK(axis.configure(kAxis));
  StopLimits limits{};
  TEST_ASSERT_OK(StopLimits::make(kAxis.quick_stop_deceleration, 4e9, kTickS, limits));
  Count stop, longest;
  StopRamp ramp;
  for (int from = 10; from < 1500; from += 100) {
    axis.reset(0);
    TEST_ASSERT_OK(axis.command(kMove, nullptr));
    Signal outputs[3] = {};
    for (int tick = 0; tick < from; ++tick) {
      outputs[2] = outputs[1];
      outputs[1] = outputs[0];
      outputs[0] = axis.tick();
    }
    ramp.start(limits, outputs[0], outputs[1], outputs[2]);
    while (!ramp.at_rest()) measure(stop, [&ramp] { static_cast<void>(ramp.tick()); });
  }
  for (int jerk_bits = 0; jerk_bits < 62; ++jerk_bits) {
    const int64_t jerk = INT64_C(1) << jerk_bits;
    for (int state_bits = jerk_bits; state_bits < 62; ++state_bits) {
      ramp.start(StopLimits{INT64_C(1) << 61, jerk}, 0, -(INT64_C(1) << state_bits), 0);
      for (int tick = 0; tick < 4; ++tick) measure(longest, [&ramp] { static_cast<void>(ramp.tick()); });
    }
  }
  axis.reset(0);
  print("\ninstructions of StopRamp::tick\n");
  print_left("", 16), print("     least      mean      most\n");
  print_row("reference move", stop);
  print_row("any numbers", longest);
  TEST_ASSERT_AT_MOST_INT64(1500, longest.most());
}

}  // namespace
