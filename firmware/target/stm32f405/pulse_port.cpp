// SPDX-License-Identifier: Apache-2.0
#include "firmware/target/stm32f405/pulse_port.hpp"

namespace stillpoint::stm32f405 {
namespace {

constexpr uint32_t kPulseMode = Timer::kCr1OnePulse | Timer::kCr1ReloadBuffered | Timer::kCr1UpdateByOverflow;
constexpr uint32_t kCounterBits = 16;  // of TIM1

void set_up_pulse_timer(Timer& timer) {
  timer.CR1 = kPulseMode;
  timer.CCMR1 = Timer::kCcmr1HighFromCompare | Timer::kCcmr1Buffered1;
  timer.CCR[0] = UINT16_MAX;
  timer.EGR = Timer::kEgrUpdate;
  timer.CCER = Timer::kCcerOutput1;
  timer.BDTR = Timer::kBdtrOutputsOn;
}

// RM0090 18.3.12. The filter takes what is shorter than 12 cycles of the timer's clock, 143 ns at 84 MHz, for noise.
void set_up_encoder_timer(Timer& timer) {
  timer.CR1 = 0;
  timer.CCMR1 = Timer::kCcmr1Input1 | Timer::kCcmr1Filter1By6 | Timer::kCcmr1Input2 | Timer::kCcmr1Filter2By6;
  timer.CCER = 0;
  timer.SMCR = Timer::kSmcrEncoderBoth;
  timer.PSC = 0;
  timer.ARR = UINT32_MAX;
  timer.CNT = 0;
  timer.CR1 = Timer::kCr1On;
}

// Everything is written before the counter runs, so nothing is loaded half.
void start(Timer& timer, const firmware::PulseBurst& burst) {
  uint32_t shift = 0;
  while ((burst.period_cycles >> shift) > 1u << kCounterBits) ++shift;
  const uint32_t period = burst.period_cycles >> shift;
  timer.PSC = (1u << shift) - 1;
  timer.ARR = period - 1;
  timer.CCR[0] = period - period / 2;
  timer.RCR = burst.count - 1;
  timer.EGR = Timer::kEgrUpdate;
  timer.CR1 = kPulseMode | Timer::kCr1On;
}

}  // namespace

void PulsePort::set_up(const PulseHardware& hardware, const firmware::PulseTiming& timing) {
  state_.hardware = hardware;
  set_up_pulse_timer(*hardware.pulse);
  set_up_encoder_timer(*hardware.encoder);
  state_.train.use(timing);
}

void PulsePort::start_tick() {
  const PulseHardware& hardware = state_.hardware;
  state_.feedback.position = static_cast<int64_t>(uint64_t{hardware.encoder->CNT} << kSignalFractionBits);
  if (state_.waiting.count == 0) return;
  if ((hardware.pulse->CR1 & Timer::kCr1On) != 0) {
    ++state_.late_bursts;
    return take_back();
  }
  // The line before the counter: what passes between the two is set-up time more.
  set_pin(*hardware.port, kDirectionPin, state_.waiting.forward);
  start(*hardware.pulse, state_.waiting);
  state_.waiting = {};
}

hal::ServoFeedback PulsePort::exchange(const hal::ServoCommand& command) {
  take_back();
  if (command.enabled && state_.enabled) {
    state_.waiting = state_.train.next(command.setpoint);
  } else {
    if (state_.enabled) stop();
    // Off, or newly on from the actual position: where the setpoint is, the drive is.
    state_.train.align(command.setpoint);
  }
  state_.enabled = command.enabled;
  set_pin(*state_.hardware.port, kEnablePin, command.enabled);
  ++state_.feedback.sequence;
  state_.feedback.valid = true;
  state_.feedback.commit = true;
  return state_.feedback;
}

void PulsePort::disable() {
  set_pin(*state_.hardware.port, kEnablePin, false);
  take_back();
  stop();
  state_.enabled = false;
}

void PulsePort::take_back() {
  if (state_.waiting.count != 0) state_.train.give_back(state_.waiting);
  state_.waiting = {};
}

// The update brings the counter to 0, and with it the output to low.
void PulsePort::stop() {
  state_.hardware.pulse->CR1 = kPulseMode;
  state_.hardware.pulse->EGR = Timer::kEgrUpdate;
}

}  // namespace stillpoint::stm32f405
