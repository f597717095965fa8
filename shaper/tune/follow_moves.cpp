// SPDX-License-Identifier: Apache-2.0
// What the tuner hears of moves that are not its own.
#include "shaper/base/shared.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint {

void AutoTune::follow(TuneSource source, int32_t lowest, int32_t highest, const ListenPlan& listen) {
  if (busy() || !memory_->claim(MemoryHolder::kTracking)) return;
  stop_listening();
  config_.source = source;
  config_.sensor_lowest = lowest;
  config_.sensor_highest = highest;
  plan_.listen = listen;
  followed_ = {};
  if (!start_listening().ok()) stop_following();
}

// Also where the memory has been taken away: the tick must not go on with it in somebody else's hands.
void AutoTune::stop_following() {
  if (busy()) return;
  stop_listening();
  memory_->release(MemoryHolder::kTracking);
}

CaptureState AutoTune::following() const {
  return memory_->held_by(MemoryHolder::kTracking) ? capture_.state() : CaptureState::kIdle;
}

Identification AutoTune::look_at_followed(uint32_t least, const Meanwhile& meanwhile) {
  Identification found{};
  found.finding = flaw_of(recorded_flaws(), recorded_ticks());
  if (found.finding != Finding::kFound) return found;
  if (followed_.count == 0) followed_ = capture_.record(load(to_error_) != 0 ? kCountsPerError : 1.0);
  found.finding = Finding::kTooShort;
  if (followed_.count < least) return found;
  found.finding = Finding::kAborted;
  size_t size = 0;
  double* const memory = borrow(size);
  if (memory == nullptr) return found;
  IdentifyConfig config;
  config.rate_hz = plan_.listen.rate_hz;
  config.ends_known = ends_known();
  const Status status = identify(followed_, config, IdentifyScratch(memory_->fit, memory, size), found, meanwhile);
  axis_->take_memory_back();
  if (!status.ok()) found.finding = Finding::kNoisy;
  return found;
}

}  // namespace stillpoint
