// SPDX-License-Identifier: Apache-2.0
// What a tuning does in the tick.
#include "shaper/base/shared.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint {

// Which sensor is known once the motion has shaken it.
void AutoTune::choose_source() {
  const bool to_error =
      config_.source == TuneSource::kFollowingError || (config_.source == TuneSource::kAuto && load(accelerates_) == 0);
  store(to_error_, to_error ? 1 : 0);
}

int32_t AutoTune::value_of(const TuneSample& sample) {
  const bool to_error = load(to_error_) != 0;
  const int32_t lowest = to_error ? INT32_MIN : config_.sensor_lowest;
  const int32_t highest = to_error ? INT32_MAX : config_.sensor_highest;
  int32_t value = sample.acceleration;
  if (to_error) {
    const Signal error =
        wrapping_difference(sample.position, sample.setpoint) >> (kSignalFractionBits - kErrorFractionBits);
    value = error > INT32_MAX ? INT32_MAX : error < INT32_MIN ? INT32_MIN : static_cast<int32_t>(error);
  }
  if (lowest < highest && sample.fresh && (value <= lowest || value >= highest)) store(clipped_, clipped_ + 1);
  return value;
}

void AutoTune::excite(const TuneSample& sample) {
  const uint32_t hears = load(hears_);
  if (hears != kRecords) hear(sample);
  Excitation& excitation = memory_->excitation;
  const ChirpBins& chirp = memory_->sine.chirp;
  const bool waits = hears == kHearsChirp && !chirp.excites();
  const Signal offset = waits ? 0 : excitation.tick();
  axis_->stream(plan_.bump_forward ? expected_ + offset : expected_ - offset);
  if (hears == kHearsChirp ? chirp.over() : excitation.over()) store(stream_, kStreamOver);
}

// A sensor is chosen before anything is summed: before the first step is held, which has shaken it; before the chirp.
void AutoTune::hear(const TuneSample& sample) {
  const Excitation& excitation = memory_->excitation;
  SineMemory& sine = memory_->sine;
  const bool is_chirp = load(hears_) == kHearsChirp;
  if (is_chirp ? !sine.chirp.excites() : excitation.step() == 0 && !excitation.held()) choose_source();
  const int32_t value = value_of(sample);
  if (sample.fresh) {
    last_ = value;
  } else {
    store(gaps_, gaps_ + 1);
  }
  if (!is_chirp) return sine.bins.tick(excitation, last_);
  if (last_ >= ChirpBins::kMost || last_ <= -ChirpBins::kMost) store(clipped_, clipped_ + 1);
  sine.chirp.tick(last_);
}

void AutoTune::tick(const TuneSample& sample) {
  if (sample.fresh && !has_first_) {
    has_first_ = true;
    first_ = sample.acceleration;
  } else if (sample.fresh && sample.acceleration != first_) {
    store(accelerates_, 1);
  }
  if (axis_ == nullptr) return;
  const AxisPhase phase = axis_->state().phase;
  if (phase == AxisPhase::kStopping) store(stopped_, 1);
  if (load(listens_) == 0 || memory_->held_by(MemoryHolder::kScope)) return;
  if (phase == AxisPhase::kStreaming && load(stream_) == kStreams) excite(sample);
  if (load(hears_) != kRecords) return;
  if (phase != AxisPhase::kAtRest) capture_.finish();
  if (capture_.state() == CaptureState::kFull) return;
  if (watch_.tick(phase == AxisPhase::kAtRest, sample.position, sample.fresh)) capture_.trigger();
  // Not while it moves: a gap or a value at the sensor's end is no flaw of the record then.
  if (!watch_.is_after_motion()) return choose_source();
  const int32_t value = value_of(sample);
  capture_.tick(&value, sample.fresh);
}

}  // namespace stillpoint
