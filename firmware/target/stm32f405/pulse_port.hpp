// SPDX-License-Identifier: Apache-2.0
// The way to a drive with a pulse input: pulse and direction out, the encoder of the motor or of the load back.
//
// NOT RUN ON SILICON. It has been run against a model of the timers' registers (tests/firmware), which is written from
// the same pages of the manual as this is; the emulator has no such timers.
#pragma once

#include <stdint.h>

#include "firmware/pulse_train.hpp"
#include "firmware/target/stm32f405/pins.hpp"
#include "firmware/target/stm32f405/registers.hpp"
#include "hal/servo_port.hpp"

namespace stillpoint::stm32f405 {

// TIM1's repetition counter has 8 bits (RM0090 17.4.13).
constexpr uint32_t kMostPulsesPerTick = 256;

struct PulseHardware {
  Timer* pulse;    // an advanced one: TIM1, TIM8
  Timer* encoder;  // one of 32 bits: TIM2, TIM5
  Gpio* port;      // with kEnablePin and kDirectionPin
};

// What the port keeps; apart from it so that it stays in .bss (see ClientBuffers).
struct PulseState {
  firmware::PulseTrain train = {};
  firmware::PulseBurst waiting = {};  // for the next tick's start
  PulseHardware hardware = {};
  hal::ServoFeedback feedback = {};
  uint32_t late_bursts = 0;
  bool enabled = false;
};

// A tick's burst is computed in `exchange`, somewhere in the tick, and starts with the next tick, so that how long a
// tick computes is not in the pulses: a setpoint is reached at the end of the tick after its own.
//
// The count is hardware's: the timer runs in one-pulse mode with the repetition counter at count - 1 (RM0090 17.3.3,
// 17.3.15) and stops by itself. It is started by `start_tick` alone, once a burst: where the software stands still, the
// pulses end within the tick.
class PulsePort final : public hal::ServoPort {
 public:
  explicit constexpr PulsePort(PulseState& state) : state_(state) {}

  // Background, before the first tick; the timers' clocks and pins must be on. `timing` as plan_pulses gave it for the
  // pulse timer's clock and at most kMostPulsesPerTick pulses; zero-initialised, the port reads the encoder and emits
  // nothing.
  void set_up(const PulseHardware& hardware, const firmware::PulseTiming& timing);

  // Tick context, first of all in the tick's interrupt: latches the encoder and starts the burst that waits. A burst
  // that finds the one before still running (the tick came early by more than the configured jitter) waits a tick.
  void start_tick();

  // The feedback is the encoder as latched. Its 32 bits are a Signal's whole counts, and both wrap at the same place,
  // so nothing is to be extended. A counter cannot tell that its cable is off: `valid` is always true.
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override;

  // Stops the pulses too, a running one cut short.
  void disable() override;

  // Pulses left over, as configured, beyond what is a limit.
  bool faulted() const { return state_.train.faulted(); }
  uint32_t limited_ticks() const { return state_.train.limited_ticks(); }
  uint32_t late_bursts() const { return state_.late_bursts; }

 private:
  void take_back();
  void stop();

  PulseState& state_;
};

}  // namespace stillpoint::stm32f405
