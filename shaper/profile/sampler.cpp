// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/track.hpp"

namespace stillpoint {

namespace {

Signal rounded(Wide position) { return signal_of(Differences{{position}}); }

}  // namespace

static_assert(kTrackFractionBits - kSignalFractionBits == 64, "the signal is the upper half of a track's position");

void Sampler::rest_at(Signal position) {
  track_ = nullptr;
  position_ = position;
}

void Sampler::begin(const Track& track) {
  track_ = &track;
  tick_ = 0;
  next_switch_ = 0;
  state_ = track.start;
  position_ = signal_of(state_);
  if (track.duration_ticks == 0) {
    end();
  } else if (track.is_curve()) {
    walk_.begin_at(track.parts, track.part_count, 0);
  } else {
    add_switch();
  }
}

void Sampler::begin_at(const Track& track, uint32_t tick) {
  track_ = &track;
  tick_ = tick < track.duration_ticks ? tick : track.duration_ticks;
  if (track.is_curve() && tick < track.duration_ticks) {
    position_ = rounded(walk_.begin_at(track.parts, track.part_count, tick));
    return;
  }
  state_ = track.differences_at(tick, next_switch_);
  position_ = signal_of(state_);
  if (tick_ == track.duration_ticks && !track.cruises()) rest_at(position_);
}

// At the last tick: onto the target, or on from there at the velocity reached.
void Sampler::end() {
  state_ = track_->end;
  position_ = signal_of(state_);
  if (!track_->cruises()) track_ = nullptr;
}

void Sampler::add_switch() {
  if (next_switch_ == track_->switch_count || track_->switches[next_switch_].tick != tick_) return;
  const Differences& add = track_->switches[next_switch_].add;
  for (int i = 0; i < 4; ++i) state_.difference[i] += add.difference[i];
  ++next_switch_;
}

Signal Sampler::tick() {
  if (track_ == nullptr) return position_;
  if (tick_ == track_->duration_ticks) {  // cruising
    state_.difference[0] += state_.difference[1];
    position_ = signal_of(state_);
    return position_;
  }
  ++tick_;
  if (tick_ == track_->duration_ticks) {
    end();
    return position_;
  }
  if (track_->is_curve()) {
    position_ = rounded(walk_.next(track_->parts, track_->part_count, tick_));
    return position_;
  }
  for (int i = 0; i < 3; ++i) state_.difference[i] += state_.difference[i + 1];
  add_switch();
  position_ = signal_of(state_);
  return position_;
}

}  // namespace stillpoint
