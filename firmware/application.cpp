// SPDX-License-Identifier: Apache-2.0
#include "firmware/application.hpp"

namespace stillpoint::firmware {

void Application::begin(AxisCore& axis, const Ports& ports) {
  ports_ = ports;
  axis_ = &axis;
  parameters_.load_defaults();
  parameters_.adopt(axis.config());
  loop_.begin(axis, *ports.servo);
  drive_.begin(axis, loop_, parameters_, stream_);
  shaper_.begin(axis, parameters_, Meanwhile{serve_meanwhile, this});
  faults_.begin(ports.faults);
  tuner_.begin({&axis, ports.tune, &drive_, &shaper_, &parameters_});
  const RegisterBank::Parts parts = {&axis,        &loop_,   &drive_,  &shaper_, &tuner_,
                                     &parameters_, &faults_, &stream_, &scope_,  &keeper_};
  registers_.begin(parts);
  scope_.begin(ports.tune, parameters_, registers_.ticks_per_second());
  keeper_.begin(parts, registers_, ports.memory, ports.restart);
  line_ = {kBauds[parameters_.get(Register::kBaudIndex)],
           static_cast<LineFormat>(parameters_.get(Register::kLineFormat))};
  pulse_ratio_ = {parameters_.get(Register::kPulseRatioPulses), parameters_.get(Register::kPulseRatioCounts)};
  client_.begin(*ports.client, static_cast<uint8_t>(parameters_.get(Register::kUnitId)), frame_silence_ms(line_.baud));
  server_.begin(registers_);
}

// Out of line: the checks of the tick path look for it in the image.
[[gnu::noinline]] void Application::tick() {
  ticked_ = true;
  advance(silence_clock_);
  loop_.tick();
  if (stream_.running() && loop_.now().axis.phase == AxisPhase::kStreaming) axis_->stream(stream_.tick());
  tuner_.tick(loop_.sample());
  scope_.tick(loop_.now(), loop_.sample());
}

void Application::own_timer_tick() {
  if (!ticked_) advance(silence_clock_);
  ticked_ = false;
  advance(uptime_ms_);
  loop_.own_timer_tick();
}

void Application::poll() {
  serve();
  // Designs, identifications, plans and erases take long; an answer with a hole in it would be two broken frames.
  if (client_.sending()) return;
  keeper_.service(load(uptime_ms_));
  shaper_.service();
  tuner_.service(load(uptime_ms_), Meanwhile{serve_meanwhile, this});
  drive_.take_set_point(shaper_.waiting());
  if (!keeper_.busy()) tuner_.follow(Meanwhile{serve_meanwhile, this});
}

void Application::serve() {
  const uint32_t now = load(silence_clock_);
  feed_watchdog(now);
  const uint32_t uptime_ms = load(uptime_ms_);
  registers_.set_uptime(uptime_ms);
  drive_.set_tuning(tuner_.busy());
  drive_.service();
  tuner_.keep_watch(keeper_.busy());
  faults_.follow(drive_.loop(), uptime_ms);
  if (client_.poll(now) && server_.serve(client_)) loop_.note_client();
}

void Application::serve_meanwhile(void* application) {
  auto& self = *static_cast<Application*>(application);
  do {
    self.serve();
  } while (self.client_.sending());
}

// Alive are this loop, or a design or an identification that comes nearer to its end, and one of the two interrupts:
// the clock stands when neither comes.
void Application::feed_watchdog(uint32_t now) {
  if (now == fed_at_) return;
  fed_at_ = now;
  ports_.watchdog->feed();
}

}  // namespace stillpoint::firmware
