// SPDX-License-Identifier: Apache-2.0
// The drive on an STM32F405. Priorities: the servo link's interrupt, which runs the tick, and SysTick are equal, so
// neither ever interrupts the other; the client's line is below them; the background is `main`.
#include "firmware/application.hpp"
#include "firmware/default_axis.hpp"
#include "firmware/target/stm32f405/client_stream.hpp"
#include "firmware/target/stm32f405/clock.hpp"
#include "firmware/target/stm32f405/flash.hpp"
#include "firmware/target/stm32f405/pins.hpp"
#include "firmware/target/stm32f405/servo_link_port.hpp"
#include "firmware/target/stm32f405/systick.hpp"
#include "firmware/target/stm32f405/watchdog.hpp"
#include "shaper/axis/axis.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::stm32f405;

// What the tick follows. kServoLink: the drive's sync, as a fieldbus drive's does. kOwnTimer: SysTick, for a board
// whose ServoPort has no sync (encoder and output on the chip itself); ServoLinkPort is then to be replaced by it.
enum class TickSource : uint8_t { kServoLink, kOwnTimer };
constexpr TickSource kTickSource = TickSource::kServoLink;

// All zeros until main: .bss, no flash, no constructor at run time.
Axis<firmware::kLineCapacity> axis;
firmware::Application application;
ClientBuffers client_buffers;
ServoLinkState servo_link_state;

ClientStream client_stream(client_buffers);
ServoLinkPort servo_link_port(servo_link_state);
IndependentWatchdog watchdog;
ParameterFlash parameter_flash;

void restart() {
  set_enable_line(false);
  scb().AIRCR = Scb::kAircrReset;
  for (;;) {  // it takes a few cycles
  }
}

}  // namespace

extern "C" {

void safe_state();
void safe_state() { set_enable_line(false); }

void usart2_handler();
void usart2_handler() {
  const bool sync = servo_link_port.on_interrupt();
  if (kTickSource == TickSource::kServoLink && sync) application.tick();
}

void usart1_handler();
void usart1_handler() { client_stream.on_interrupt(); }

void systick_handler();
void systick_handler() {
  application.own_timer_tick();
  if (kTickSource == TickSource::kOwnTimer) application.tick();
}

}  // extern "C"

int main() {
  set_up_pins();
  watchdog.start();
  const Clock clock = start_clock();
  if (!axis.configure(firmware::kDefaultAxis).ok()) safe_state();
  application.begin(axis, {&servo_link_port, &client_stream, &watchdog, &parameter_flash, restart});
  client_stream.set_up(clock.apb2_hz);
  servo_link_port.set_up(clock.apb1_hz);
  start_systick(clock.core_hz);
  for (;;) application.poll();
}
