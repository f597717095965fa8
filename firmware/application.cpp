// SPDX-License-Identifier: Apache-2.0
#include "firmware/application.hpp"

namespace stillpoint::firmware {

void Application::begin(AxisCore& axis, const Ports& ports) {
  ports_ = ports;
  parameters_.load_defaults();
  parameters_.adopt(axis.config());
  loop_.begin(axis, *ports.servo);
  drive_.begin(axis, loop_, parameters_);
  shaper_.begin(axis, parameters_, Meanwhile{serve_meanwhile, this});
  const RegisterBank::Parts parts = {&axis, &loop_, &drive_, &shaper_, &parameters_, &keeper_};
  registers_.begin(parts);
  keeper_.begin(parts, registers_, ports.memory, ports.restart);
  client_.begin(*ports.client, static_cast<uint8_t>(parameters_.get(Register::kUnitId)));
  server_.begin(registers_);
}

void Application::tick() {
  ticked_ = true;
  advance(silence_clock_);
  loop_.tick();
}

void Application::own_timer_tick() {
  if (!ticked_) advance(silence_clock_);
  ticked_ = false;
  advance(uptime_ms_);
  loop_.own_timer_tick();
}

void Application::poll() {
  serve();
  // Designs, plans and erases take long; an answer with a hole in it would be two broken frames.
  if (client_.sending()) return;
  keeper_.service(load(uptime_ms_));
  shaper_.service();
  drive_.take_set_point(shaper_.waiting());
}

void Application::serve() {
  const uint32_t now = load(silence_clock_);
  feed_watchdog(now);
  registers_.set_uptime(load(uptime_ms_));
  drive_.service();
  if (client_.poll(now)) server_.serve(client_);
}

void Application::serve_meanwhile(void* application) {
  auto& self = *static_cast<Application*>(application);
  do {
    self.serve();
  } while (self.client_.sending());
}

// Alive are this loop, or a design that comes nearer to its end, and one of the two interrupts: the clock stands when
// neither comes.
void Application::feed_watchdog(uint32_t now) {
  if (now == fed_at_) return;
  fed_at_ = now;
  ports_.watchdog->feed();
}

}  // namespace stillpoint::firmware
