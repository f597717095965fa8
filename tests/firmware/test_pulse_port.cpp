// SPDX-License-Identifier: Apache-2.0
// The STM32F405's pulse port against a model of its timers' registers. Neither has been held against silicon.
#include "firmware/target/stm32f405/pulse_port.hpp"

#include <algorithm>

#include "tests/firmware/pulse_model.hpp"
#include "tests/support/random.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;
using namespace stillpoint::stm32f405;
using namespace stillpoint::testing;

namespace {

constexpr PulseConfig kConfig = kBoardConfig;
constexpr uint64_t kTick = kBoardTick;
constexpr uint64_t kJitter = kBoardJitter;

struct Standing : Board {
  Standing() {
    begin(kConfig);
    tick(0);
  }
};

}  // namespace

TEST_F(Standing, the_timer_emits_exactly_the_pulses_of_a_tick_and_stops) {
  int64_t position = 0;
  for (int64_t count = 1; count <= 198; ++count) {
    const int64_t step = std::min<int64_t>(count, 99);  // the first is a reversal of the line
    for (const int64_t move : {step, count}) {
      position += move;
      tick(position);
      start_tick();  // these are emitted in this tick
      TEST_ASSERT_TRUE(pulse.running());
      drive.forget_gaps();
      pulse.run_to(tick_at + kTick - 168 - kJitter);
      TEST_ASSERT_FALSE(pulse.running());
      TEST_ASSERT_EQUAL_INT64(position, drive.count);
      if (move == 1) continue;
      // Even: each period the same, and within one step of the timer of what a tick gives.
      TEST_ASSERT_EQUAL_UINT64(drive.shortest_gap, drive.longest_gap);
      const double even = static_cast<double>(kTick - 168 - kJitter - 1) / static_cast<double>(move);
      const double step_of_timer = even > 131072.0 ? 4.0 : even > 65536.0 ? 2.0 : 1.0;
      TEST_ASSERT_DOUBLE_WITHIN(step_of_timer, even, static_cast<double>(drive.longest_gap));
    }
  }
}

TEST_F(Standing, at_a_constant_speed_the_pause_over_the_ticks_end_is_longer_by_what_is_kept_free) {
  uint64_t worst = 0;
  int64_t position = 0;
  for (const int64_t count : {1, 3, 10, 99, 150, 197, 198}) {
    for (int ticks = 0; ticks < 50; ++ticks) {
      if (ticks == 5) drive.forget_gaps();
      position += count;
      tick(position);
    }
    TEST_ASSERT_EQUAL_INT64(0, port.late_bursts());
    TEST_ASSERT_AT_MOST_INT64(168 + kJitter + 1 + static_cast<uint64_t>(count), drive.longest_gap - drive.shortest_gap);
    worst = std::max(worst, drive.longest_gap - drive.shortest_gap);
  }
  TEST_ASSERT_AT_LEAST_INT64(kJitter, worst);
}

TEST_F(Standing, where_the_software_stands_still_the_pulses_end_with_the_tick) {
  tick(50);
  start_tick();
  pulse.run_to(now + 100 * kTick);
  TEST_ASSERT_EQUAL_INT64(50, drive.count);
  TEST_ASSERT_FALSE(pulse.running());
}

TEST_F(Standing, a_tick_that_comes_while_pulses_run_puts_its_own_off_and_loses_none) {
  tick(40);
  tick(80);
  tick_at -= kTick / 2;  // half a tick early
  start_tick();
  exchange({signal_from_counts(120), true});
  TEST_ASSERT_EQUAL_UINT32(1, port.late_bursts());
  tick(120);
  tick(120);
  start_tick();
  TEST_ASSERT_EQUAL_INT64(120, drive.count);
}

TEST_F(Standing, a_second_exchange_in_a_tick_takes_the_first_ones_pulses_back) {
  tick(40);
  exchange({signal_from_counts(30), true});
  tick(30);
  tick(30);
  TEST_ASSERT_EQUAL_INT64(30, drive.count);
}

TEST_F(Standing, disabling_stops_the_pulses_and_enabling_again_sends_none) {
  tick(90);
  start_tick();
  exchange({signal_from_counts(90), false});
  TEST_ASSERT_FALSE(gpio.enabled);
  TEST_ASSERT_FALSE(pulse.running());
  const int64_t stopped_at = drive.count;
  TEST_ASSERT_AT_MOST_INT64(89, stopped_at);
  // Enabled from elsewhere: the motor was pushed.
  for (int ticks = 0; ticks < 5; ++ticks) tick(100000, ticks >= 2);
  TEST_ASSERT_TRUE(gpio.enabled);
  TEST_ASSERT_EQUAL_INT64(stopped_at, drive.count);
  tick(100001);
  tick(100001);
  tick(100001);
  TEST_ASSERT_EQUAL_INT64(stopped_at + 1, drive.count);
}

TEST_F(Standing, the_loops_disable_takes_effect_at_once) {
  tick(90);
  start_tick();
  exchange({signal_from_counts(180), true});
  port.disable();
  look();
  const int64_t stopped_at = drive.count;
  TEST_ASSERT_FALSE(gpio.enabled);
  start_tick();
  pulse.run_to(now + 10 * kTick);
  TEST_ASSERT_EQUAL_INT64(stopped_at, drive.count);
}

TEST_F(Board, the_encoder_is_followed_over_its_32_bits_both_ways) {
  begin(kConfig);
  TEST_ASSERT_EQUAL_UINT32(Timer::kSmcrEncoderBoth, encoder.SMCR);
  TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, encoder.ARR);
  TEST_ASSERT_EQUAL_UINT32(0x4141, encoder.CCMR1);
  TEST_ASSERT_EQUAL_UINT32(Timer::kCr1On, encoder.CR1);
  Random random(1);
  int64_t turned = 0;
  for (const int64_t way : {1, -1}) {
    Signal before = tick(0, false).position;
    for (int ticks = 0; ticks < 20000; ++ticks) {
      const int64_t step = way * random.integer(0, 1 << 20);
      encoder_zero += static_cast<uint32_t>(step);
      turned += step;
      const hal::ServoFeedback feedback = tick(0, false);
      TEST_ASSERT_EQUAL_INT64(step * kSignalPerCount, wrapping_difference(feedback.position, before));
      TEST_ASSERT_EQUAL_UINT32(state.feedback.sequence, feedback.sequence);
      before = feedback.position;
    }
    TEST_ASSERT_TRUE(way < 0 || turned > INT64_C(1) << 32);
  }
}

TEST_F(Board, without_a_timing_the_port_emits_nothing) {
  port.set_up({&pulse.registers, &encoder, &gpio.registers}, {});
  look();
  for (const int64_t position : {10, 20, 20}) tick(position);
  TEST_ASSERT_EQUAL_INT64(0, drive.count);
}
