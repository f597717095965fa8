// SPDX-License-Identifier: Apache-2.0
// The drive on an STM32F405, in two images that differ in the way to the servo (STILLPOINT_SERVO). Priorities: the
// servo link's interrupt, which runs the tick, and SysTick are equal, so neither ever interrupts the other; the
// client's line is below them; the background is `main`.
#include "firmware/application.hpp"
#include "firmware/default_axis.hpp"
#include "firmware/target/stm32f405/client_stream.hpp"
#include "firmware/target/stm32f405/clock.hpp"
#include "firmware/target/stm32f405/flash.hpp"
#include "firmware/target/stm32f405/pins.hpp"
#include "firmware/target/stm32f405/pulse_port.hpp"
#include "firmware/target/stm32f405/servo_link_port.hpp"
#include "firmware/target/stm32f405/stack_guard.hpp"
#include "firmware/target/stm32f405/systick.hpp"
#include "firmware/target/stm32f405/watchdog.hpp"
#include "shaper/axis/axis.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::stm32f405;

// kLink: the servo link; the tick follows the drive's sync, as a fieldbus drive's does. kPulses: encoder and output are
// on the chip itself and there is no sync; the tick follows SysTick. What an image does not use is not in it.
enum class Servo : uint8_t { kLink, kPulses };
constexpr Servo kServo = Servo::STILLPOINT_SERVO;

// But for the ratio, which the registers have: a pulse a hundred counts is their default, 100,000 a second at the
// default axis's full speed. Times as opto-coupled inputs ask for. SysTick shares its priority with nothing here, so a
// tick starts late only by what masks interrupts.
constexpr firmware::PulseTiming pulse_timing(uint32_t core_hz) {
  firmware::PulseTiming timing{};
  static_cast<void>(firmware::plan_pulses(
      {1, 1, core_hz, 200000, 1000000, 2500, 5000, 1000, 4000, kMostPulsesPerTick, 100, false}, timing));
  return timing;
}
constexpr firmware::PulseTiming kPulseTiming = pulse_timing(168000000), kSlowPulseTiming = pulse_timing(16000000);
static_assert(kPulseTiming.most != 0 && kSlowPulseTiming.most != 0, "plan_pulses has refused");

// All zeros until main: .bss, no flash, no constructor at run time.
Axis<firmware::kLineCapacity> axis;
firmware::Application application;
TuneMemory tune_memory;
ClientBuffers client_buffers;
ServoLinkState servo_link_state;
PulseState pulse_state;
__attribute__((section(".noinit"))) firmware::FaultMemory fault_memory;

ClientStream client_stream(client_buffers);
ServoLinkPort servo_link_port(servo_link_state);
PulsePort pulse_port(pulse_state);
IndependentWatchdog watchdog;
ParameterFlash parameter_flash;

void restart() {
  set_enable_line(false);
  scb().AIRCR = Scb::kAircrReset;
  for (;;) {  // it takes a few cycles
  }
}

void tick() {
  const Overrun overrun;
  application.tick();
  if (overrun.happened()) application.note_overrun();
}

hal::ServoPort& servo_port() {
  if constexpr (kServo == Servo::kPulses) return pulse_port;
  return servo_link_port;
}

void set_up_servo(const Clock& clock) {
  if constexpr (kServo == Servo::kLink) {
    servo_link_port.set_up(clock.apb1_hz);
  } else {
    rcc().APB1ENR = rcc().APB1ENR | Rcc::kApb1Timer2;
    rcc().APB2ENR = rcc().APB2ENR | Rcc::kApb2Timer1;
    set_up_pulse_pins();
    // With the dividers of clock.cpp, TIM1 runs at the core's clock (RM0090 7.2).
    firmware::PulseTiming timing = clock.source == ClockSource::kInternal ? kSlowPulseTiming : kPulseTiming;
    timing.ratio = application.pulse_ratio();
    pulse_port.set_up({&timer1(), &timer2(), &gpio_c()}, timing);
  }
}

bool watchdog_bit() {
  const bool bit = (rcc().CSR & Rcc::kCsrWatchdogReset) != 0;
  rcc().CSR = rcc().CSR | Rcc::kCsrForgetResets;
  return bit;
}

}  // namespace

extern "C" {

void safe_state();
void safe_state() { set_enable_line(false); }

void usart2_handler();
void usart2_handler() {
  if constexpr (kServo == Servo::kLink) {
    if (servo_link_port.on_interrupt()) tick();
  }
}

void usart1_handler();
void usart1_handler() { client_stream.on_interrupt(); }

void systick_handler();
void systick_handler() {
  if constexpr (kServo == Servo::kPulses) pulse_port.start_tick();
  if (!StackGuard::intact()) application.note_fault(firmware::FaultCode::kStackOverflow);
  application.own_timer_tick();
  if constexpr (kServo == Servo::kPulses) {
    tick();
    if (pulse_port.faulted()) application.note_fault(firmware::FaultCode::kFollowingError);
  }
}

}  // extern "C"

int main() {
  StackGuard::lay();
  set_up_pins();
  const bool bitten = watchdog_bit();
  watchdog.start();
  const Clock clock = start_clock();
  if (!axis.configure(firmware::kDefaultAxis).ok()) safe_state();
  application.begin(axis,
                    {&servo_port(), &client_stream, &watchdog, &fault_memory, &tune_memory, &parameter_flash, restart});
  if (bitten) application.note_fault(firmware::FaultCode::kWatchdog);
  client_stream.set_up(clock.apb2_hz, application.line());
  set_up_servo(clock);
  start_systick(clock.core_hz);
  for (;;) application.poll();
}
