// SPDX-License-Identifier: Apache-2.0
// Streamed setpoints, both sides.
#include "shaper/axis/axis_core.hpp"

namespace stillpoint {

// --- background -----------------------------------------------------------------------------------------------------

Status AxisCore::begin_stream(const StreamConfig& config) {
  const uint32_t epoch = load(epoch_);
  Status status = check_ready();
  if (status.ok()) status = config.limits.validate();
  if (status.ok()) status = config.limits.within(config_.maximum);
  if (status.ok()) status = check_wrap(config.limits.velocity);
  if (status.ok() && !running().averages()) status = refuse(Error::kNotAvailable, Quantity::kKind);
  if (status.ok()) status = StreamLimits::make(config.limits, config_.tick_s, stream_limits_);
  if (!status.ok()) return status;
  stream_policy_ = config.policy;
  made_up_ticks_ = config.made_up_ticks;
  stream_begin_count_ = load(streamed_count_);
  store(stream_end_requested_, 0);
  // The tick writes it only while it streams. Not left to the tick that begins: that may be held up.
  store(stream_faulted_, 0);
  hand_over_move(kStream, epoch);
  return status;
}

StreamState AxisCore::stream_state() const {
  return StreamState{load(limiting_) != 0, load(stream_faulted_) != 0, load(limited_ticks_)};
}

void AxisCore::stream(Signal setpoint) {
  const uint32_t count = load(streamed_count_) + 1;
  streamed_[count & 1] = setpoint;
  store(streamed_count_, count);
}

// --- tick -----------------------------------------------------------------------------------------------------------

void AxisCore::start_stream() {
  limiter_.start(stream_limits_, stream_policy_, made_up_ticks_, outputs_[0], outputs_[0], outputs_[0]);
  limiter_.keep_between(soft_low_, soft_high_);
  stream_seen_ = stream_begin_count_;
  streaming_ = true;
  store(pending_move_, kNoMove);
}

Signal AxisCore::follow_stream() {
  if (load(stream_end_requested_) != 0) {
    store(stream_end_requested_, 0);
    limiter_.stop();
  }
  const uint32_t count = load(streamed_count_);
  const Signal output = count != stream_seen_ ? limiter_.tick(streamed_[count & 1]) : limiter_.tick();
  stream_seen_ = count;
  store(limiting_, limiter_.limiting() ? 1 : 0);
  store(stream_faulted_, limiter_.faulted() ? 1 : 0);
  store(limited_ticks_, limiter_.limited_ticks());
  if (limiter_.stopped()) {
    streaming_ = false;
    store(limiting_, 0);
    sampler_.rest_at(output);
  }
  return output;
}

}  // namespace stillpoint
