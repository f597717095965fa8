// SPDX-License-Identifier: Apache-2.0
#include "firmware/tuner.hpp"

namespace stillpoint::firmware {

void Tuner::begin(const Parts& parts) {
  if (parts.memory == nullptr) return;
  tuner_.begin(*parts.axis, *parts.memory);
  settings_.begin({parts.axis, &tuner_, parts.drive, parts.shaper, parts.parameters});
  tracking_.begin({parts.axis, &tuner_, parts.drive, parts.shaper, &settings_, parts.parameters});
}

bool Tuner::available() const { return settings_.available(); }

bool Tuner::command(TuneCommand command, const Parameters& staged, uint32_t now_ms) {
  return settings_.command(command, staged, now_ms);
}

void Tuner::keep_watch(bool background_wanted) {
  settings_.keep_watch();
  tracking_.keep_watch(background_wanted);
}

void Tuner::service(uint32_t now_ms, const Meanwhile& meanwhile) { settings_.service(now_ms, meanwhile); }

void Tuner::follow(const Meanwhile& meanwhile) { tracking_.service(meanwhile); }

void Tuner::show() { settings_.show(); }

bool Tuner::busy() const { return settings_.busy(); }

void Tuner::tick(const TuneSample& sample) { tuner_.tick(sample); }

}  // namespace stillpoint::firmware
