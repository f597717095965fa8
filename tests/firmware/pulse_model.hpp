// SPDX-License-Identifier: Apache-2.0
// What hangs on the pulse port, in cycles of the pulse timer's clock: an advanced timer that lives by its registers as
// RM0090 17.3 describes them, and a drive that counts its edges and holds them against its data sheet. Not silicon.
#pragma once

#include <stdint.h>

#include "firmware/target/stm32f405/pins.hpp"
#include "firmware/target/stm32f405/pulse_port.hpp"
#include "firmware/target/stm32f405/registers.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

// A pulse input. Counts rising edges.
struct ModelDrive {
  uint64_t width, setup, hold;  // cycles that it asks for
  int64_t count = 0;
  bool pulse = false;
  bool forward = false;
  uint64_t rose_at = 0, fell_at = 0, turned_at = 0;
  uint64_t shortest_gap = UINT64_MAX, longest_gap = 0;  // between two edges since forget_gaps
  uint64_t rises = 0;
  uint64_t rises_at_forget = 0;

  void forget_gaps() {
    shortest_gap = UINT64_MAX;
    longest_gap = 0;
    rises_at_forget = rises;
  }
  void set_pulse(bool high, uint64_t at) {
    if (high == pulse) return;
    pulse = high;
    if (!high) {
      TEST_ASSERT_AT_LEAST_INT64(width, at - rose_at);
      fell_at = at;
      return;
    }
    if (rises != 0) TEST_ASSERT_AT_LEAST_INT64(width, at - fell_at);
    TEST_ASSERT_AT_LEAST_INT64(setup, at - turned_at);
    if (rises != rises_at_forget) {
      const uint64_t gap = at - rose_at;
      shortest_gap = gap < shortest_gap ? gap : shortest_gap;
      longest_gap = gap > longest_gap ? gap : longest_gap;
    }
    ++rises;
    rose_at = at;
    count += forward ? 1 : -1;
  }
  void set_forward(bool high, uint64_t at) {
    if (high == forward) return;
    TEST_ASSERT_FALSE(pulse);
    if (rises != 0) TEST_ASSERT_AT_LEAST_INT64(hold, at - fell_at);
    forward = high;
    turned_at = at;
  }
};

// TIM1: up-counting, channel 1. Everything else that the registers could ask for is refused.
class TimerModel {
 public:
  stm32f405::Timer registers{};

  explicit TimerModel(ModelDrive& drive) : drive_(drive) {}

  // What the software has written, at this time.
  void look(uint64_t now) {
    using stm32f405::Timer;
    TEST_ASSERT_EQUAL_UINT32(0, registers.SMCR);
    if ((registers.EGR & Timer::kEgrUpdate) != 0) {
      registers.EGR = 0;
      update();
      counter_since_ = now;
      show(now);
    }
    const bool on = (registers.CR1 & Timer::kCr1On) != 0;
    if (on && !running_) counter_since_ = now;
    running_ = on;
  }

  void run_to(uint64_t now) {
    using stm32f405::Timer;
    while (running_) {
      const uint64_t compare = counter_since_ + uint64_t{compare_} * step_;
      const uint64_t overflow = counter_since_ + (uint64_t{reload_} + 1) * step_;
      if (compare <= now && compare < overflow && !high_) {
        high_ = true;
        show(compare);
      }
      if (overflow > now) return;
      counter_since_ = overflow;
      high_ = compare_ == 0;
      show(overflow);
      if (repetitions_ != 0) {
        --repetitions_;
        continue;
      }
      update();
      if ((registers.CR1 & Timer::kCr1OnePulse) != 0) {
        registers.CR1 = registers.CR1 & ~Timer::kCr1On;
        running_ = false;
      }
    }
  }
  bool running() const { return running_; }

 private:
  // An update event: the buffered registers come into force, the repetitions begin anew (17.3.3).
  void update() {
    using stm32f405::Timer;
    TEST_ASSERT_AT_MOST_INT64(UINT16_MAX, registers.PSC);
    TEST_ASSERT_AT_MOST_INT64(UINT16_MAX, registers.ARR);
    TEST_ASSERT_AT_MOST_INT64(UINT8_MAX, registers.RCR);
    TEST_ASSERT_AT_MOST_INT64(UINT16_MAX, registers.CCR[0]);
    TEST_ASSERT_TRUE((registers.CR1 & Timer::kCr1ReloadBuffered) != 0);
    TEST_ASSERT_EQUAL_UINT32(Timer::kCcmr1HighFromCompare | Timer::kCcmr1Buffered1, registers.CCMR1);
    step_ = registers.PSC + 1;
    reload_ = registers.ARR;
    compare_ = registers.CCR[0];
    repetitions_ = registers.RCR;
    high_ = compare_ == 0;
  }
  void show(uint64_t at) {
    using stm32f405::Timer;
    const bool out = (registers.CCER & Timer::kCcerOutput1) != 0 && (registers.BDTR & Timer::kBdtrOutputsOn) != 0;
    drive_.set_pulse(out && high_, at);
  }

  ModelDrive& drive_;
  bool running_ = false;
  bool high_ = false;
  uint64_t counter_since_ = 0;  // when the counter was 0
  uint32_t step_ = 1, reload_ = 0, compare_ = 0, repetitions_ = 0;
};

// Port C: what was written to BSRR becomes a level.
struct PortModel {
  stm32f405::Gpio registers{};
  bool enabled = false;

  void look(ModelDrive& drive, uint64_t now) {
    const uint32_t set = registers.BSRR & 0xFFFF, reset = registers.BSRR >> 16;
    registers.BSRR = 0;
    if (((set | reset) >> stm32f405::kDirectionPin & 1) != 0) {
      drive.set_forward((set >> stm32f405::kDirectionPin & 1) != 0, now);
    }
    if (((set | reset) >> stm32f405::kEnablePin & 1) != 0) enabled = (set >> stm32f405::kEnablePin & 1) != 0;
  }
};

constexpr firmware::PulseConfig kBoardConfig{
    1, 1, 168000000, 200000, 1000000, 2500, 5000, 1000, 4000, stm32f405::kMostPulsesPerTick, 0, false};
constexpr uint64_t kBoardTick = 168000;  // cycles
constexpr uint64_t kBoardJitter = 672;

// The port with everything that hangs on it; the motor stands where the drive's pulses have brought it.
struct Board {
  ModelDrive drive{420, 840, 168};  // of kBoardConfig
  TimerModel pulse{drive};
  stm32f405::Timer encoder{};
  PortModel gpio;
  stm32f405::PulseState state;
  stm32f405::PulsePort port{state};
  uint64_t now = 0;                // in the newest tick
  uint64_t tick_at = 0;            // when that began, without its jitter
  int64_t counts = 1, pulses = 1;  // of the encoder, a pulse
  uint32_t encoder_zero = 0;

  void begin(const firmware::PulseConfig& config) {
    firmware::PulseTiming timing{};
    TEST_ASSERT_OK(plan_pulses(config, timing));
    port.set_up({&pulse.registers, &encoder, &gpio.registers}, timing);
    look();
    TEST_ASSERT_FALSE(pulse.running());
  }
  void look() {
    gpio.look(drive, now);  // the line before the counter, as in the port
    pulse.look(now);
  }
  // The next tick begins; everything until then has happened.
  void start_tick(int64_t late = 0) {
    tick_at += kBoardTick;
    now = tick_at + static_cast<uint64_t>(late);
    pulse.run_to(now);
    encoder.CNT = encoder_zero + static_cast<uint32_t>(drive.count * counts / pulses);
    port.start_tick();
    look();
  }
  // Some way into the tick.
  hal::ServoFeedback exchange(const hal::ServoCommand& command) {
    now += 20000;
    pulse.run_to(now);
    const hal::ServoFeedback feedback = port.exchange(command);
    look();
    return feedback;
  }
  hal::ServoFeedback tick(int64_t position, bool enabled = true) {
    start_tick();
    return exchange({signal_from_counts(static_cast<int32_t>(position)), enabled});
  }
};

}  // namespace stillpoint::testing
