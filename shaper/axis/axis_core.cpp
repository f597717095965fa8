// SPDX-License-Identifier: Apache-2.0
// The tick's side of the axis, and how requests cross to it.
#include "shaper/axis/axis_core.hpp"

namespace stillpoint {

void AxisCore::attach(LineSample* active_memory, LineSample* spare_memory, size_t line_capacity) {
  if (capacity_ != 0) return;
  memory_[0] = active_memory;
  memory_[1] = spare_memory;
  capacity_ = line_capacity;
}

AxisState AxisCore::state() const { return published_.read(); }

bool AxisCore::pending() const { return load(pending_) != kNothing || load(pending_move_) != kNoMove; }

ShaperDesign AxisCore::shaper() const { return running().design(); }

void AxisCore::request_stop() { store(stop_requested_, 1); }

void AxisCore::hand_over(Pending what, uint32_t epoch) {
  pending_epoch_ = epoch;
  store(pending_, what);
}

[[gnu::noinline]] void AxisCore::hand_over_move(PendingMove what, uint32_t epoch) {
  move_epoch_ = epoch;
  flight_armed_ = false;
  store(pending_move_, what);
}

// Out of line also where an image is optimised as a whole: the checks of the tick look for it there.
[[gnu::noinline]] Signal AxisCore::tick(bool commit) {
  if (load(stop_requested_) != 0) {
    store(stop_requested_, 0);
    begin_stop();
  }
  take_move(commit);
  const uint32_t what = load(pending_);
  if (what != kNothing && commit) take_pending(what);
  ++track_ticks_;
  const Signal setpoint = advance();
  outputs_[2] = outputs_[1];
  outputs_[1] = outputs_[0];
  outputs_[0] = setpoint;
  publish(setpoint);
  return setpoint;
}

Signal AxisCore::advance() {
  if (stopping_) {
    const Signal position = stop_ramp_.tick();
    if (stop_ramp_.at_rest()) rest_at(position);
    return position;
  }
  if (!sampler_.at_rest() || streaming_) {
    drain_ticks_ = length_ticks_;
  } else if (drain_ticks_ > 0) {
    --drain_ticks_;
  }
  const Signal input = streaming_ ? follow_stream() : sampler_.tick();
  const Signal output = shapers_[active_shaper_].tick(input);
  return blending_ ? blend(input, output) : output;
}

Signal AxisCore::blend(Signal input, Signal output) {
  const Signal next = shapers_[active_shaper_ ^ 1].tick(input);
  if (blend_wait_ != 0) {
    --blend_wait_;
    return output;
  }
  const Signal mixed = blend_ramp_.tick(output, next);
  if (blend_ramp_.done()) end_blend();
  return mixed;
}

void AxisCore::take_move(bool commit) {
  const uint32_t what = load(pending_move_);
  if (what == kNoMove) {
    flight_armed_ = false;
  } else if (move_epoch_ != epoch_) {
    store(pending_move_, kNoMove);
  } else if (what == kFromRest || what == kStream) {
    if (!commit || published_.latest().phase != AxisPhase::kAtRest || stopping_) return;
    if (what == kStream) return start_stream();
    begin_track();
  } else if (what == kInFlight) {
    flight_armed_ = flight_armed_ || commit;
    const auto late = static_cast<int32_t>(published_.latest().tick - flight_at_);
    if (late == 0 && flight_armed_ && !blending_) {
      begin_track();
    } else if (late >= 0) {
      store(pending_move_, kMissed);
    }
  }
}

void AxisCore::begin_track() {
  active_track_ ^= 1;
  sampler_.begin(tracks_[active_track_]);
  track_ticks_ = 0;
  flight_armed_ = false;
  store(pending_move_, kNoMove);
}

void AxisCore::take_pending(uint32_t what) {
  if (blending_ || load(looking_) != 0) return;
  if (published_.latest().phase == AxisPhase::kAtRest && !stopping_) {
    if (sampler_.at_rest() && !streaming_) take_shaper(what);
  } else if (what == kBlend && !stopping_) {
    begin_blend();
  }
}

void AxisCore::take_shaper(uint32_t what) {
  store(active_shaper_, active_shaper_ ^ 1);
  length_ticks_ = shapers_[active_shaper_].length_ticks();
  if (what != kShaper || pending_epoch_ != epoch_) shapers_[active_shaper_].fill(outputs_[0]);
  store(pending_, kNothing);
}

// The new line is not filled: fed for its length before the blend, it holds what it would hold had it run for ever.
// Where that no longer fits, the background was late.
void AxisCore::begin_blend() {
  const uint32_t wait = blend_begin_ - (published_.latest().tick + 1);
  const uint32_t length = shapers_[active_shaper_ ^ 1].length_ticks();
  if (pending_epoch_ != epoch_ || static_cast<int32_t>(wait) < static_cast<int32_t>(length)) {
    store(pending_, kLaterShaper);
    return;
  }
  blending_ = true;
  blend_wait_ = wait + 1;
  blend_ramp_.begin(blend_order_);
  if (length > length_ticks_) set_length(length);
}

void AxisCore::end_blend() {
  blending_ = false;
  store(active_shaper_, active_shaper_ ^ 1);
  set_length(shapers_[active_shaper_].length_ticks());
  store(pending_, kNothing);
}

// Only on the way to rest, where the new shaper then takes effect.
[[gnu::noinline]] void AxisCore::drop_blend() {
  if (!blending_) return;
  blending_ = false;
  length_ticks_ = shapers_[active_shaper_].length_ticks();
  store(pending_, kLaterShaper);
}

void AxisCore::set_length(uint32_t length_ticks) {
  const uint32_t drained = length_ticks_ - drain_ticks_;
  drain_ticks_ = length_ticks > drained ? length_ticks - drained : 0;
  length_ticks_ = length_ticks;
}

void AxisCore::begin_stop() {
  ++epoch_;
  if (stopping_ || published_.latest().phase == AxisPhase::kAtRest) return;
  drop_blend();
  stop_ramp_.start(stop_limits_, outputs_[0], outputs_[1], outputs_[2]);
  stopping_ = true;
}

[[gnu::noinline]] void AxisCore::rest_at(Signal position) {
  sampler_.rest_at(position);
  streaming_ = false;
  shapers_[active_shaper_].fill(position);
  drain_ticks_ = 0;
  stopping_ = false;
}

void AxisCore::reset(Signal position) {
  ++epoch_;
  store(stop_requested_, 0);
  drop_blend();
  rest_at(position);
  for (int i = 0; i < 3; ++i) outputs_[i] = position;
  turns_.zero = 0;
  publish(position);
}

void AxisCore::publish(Signal setpoint) {
  const AxisPhase phase = stopping_                        ? AxisPhase::kStopping
                          : streaming_                     ? AxisPhase::kStreaming
                          : !sampler_.at_rest()            ? AxisPhase::kMoving
                          : drain_ticks_ != 0 || blending_ ? AxisPhase::kDraining
                                                           : AxisPhase::kAtRest;
  const Signal demand = stopping_ ? setpoint : streaming_ ? limiter_.position() : sampler_.position();
  turns_.follow(setpoint);
  published_.publish(AxisState{published_.latest().tick + 1, phase, track_ticks_, demand, setpoint, turns_.zero});
}

int32_t AxisCore::reading_counts() const {
  if (turns_.counts == 0) return 0;
  const AxisState now = state();
  const Turns turns{turns_.counts, turns_.step, now.zero};
  const int32_t counts = counts_from_signal(turns.reading(now.setpoint));
  return counts == static_cast<int32_t>(config_.modulo_counts) ? 0 : counts;
}

}  // namespace stillpoint
