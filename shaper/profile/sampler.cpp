// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/track.hpp"

namespace stillpoint {

namespace {

constexpr int kExtraBits = kTrackFractionBits - kSignalFractionBits;
static_assert(kExtraBits == 64, "the signal is the upper half of a track's position");

Wide wide_from_signal(Signal signal) { return Wide{0, static_cast<uint64_t>(signal)}; }

// To the nearest LSB, halves up.
Signal signal_from_wide(Wide wide) { return static_cast<Signal>(wide.high + (wide.low >> 63)); }

}  // namespace

void Sampler::rest_at(Signal position) {
  track_ = nullptr;
  position_ = position;
}

void Sampler::begin(const Track& track) {
  if (track.duration_ticks == 0) {
    rest_at(track.target);
    return;
  }
  track_ = &track;
  tick_ = 0;
  next_switch_ = 0;
  position_ = track.start;
  state_ = Differences{};
  state_.difference[0] = wide_from_signal(track.start);
  add_switch();
}

void Sampler::begin_at(const Track& track, uint32_t tick) {
  if (tick >= track.duration_ticks) {
    rest_at(track.target);
    return;
  }
  track_ = &track;
  tick_ = tick;
  state_ = track.differences_at(tick, next_switch_);
  position_ = signal_from_wide(state_.difference[0]);
}

void Sampler::add_switch() {
  if (next_switch_ == track_->switch_count || track_->switches[next_switch_].tick != tick_) return;
  const Differences& add = track_->switches[next_switch_].add;
  for (int i = 0; i < 4; ++i) state_.difference[i] += add.difference[i];
  ++next_switch_;
}

Signal Sampler::tick() {
  if (track_ == nullptr) return position_;
  ++tick_;
  if (tick_ == track_->duration_ticks) {
    rest_at(track_->target);
    return position_;
  }
  for (int i = 0; i < 3; ++i) state_.difference[i] += state_.difference[i + 1];
  add_switch();
  position_ = signal_from_wide(state_.difference[0]);
  return position_;
}

}  // namespace stillpoint
