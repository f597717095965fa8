// SPDX-License-Identifier: Apache-2.0
#include "firmware/control_loop.hpp"

namespace stillpoint::firmware {
namespace {

// Positions may lie 2^64 - 1 LSB apart, so the distance is unsigned.
bool within_counts(Signal a, Signal b, uint32_t window_counts) {
  const uint64_t distance =
      a > b ? static_cast<uint64_t>(a) - static_cast<uint64_t>(b) : static_cast<uint64_t>(b) - static_cast<uint64_t>(a);
  return distance <= uint64_t{window_counts} << kSignalFractionBits;
}

}  // namespace

void ControlLoop::begin(AxisCore& axis, hal::ServoPort& servo) {
  axis_ = &axis;
  servo_ = &servo;
  publish();
}

void ControlLoop::publish() {
  state_.axis = axis_->state();
  published_.publish(state_);
}

void ControlLoop::tick() {
  silent_ms_ = 0;
  state_.link_silent = false;
  ++state_.ticks;
  obey_clear_and_disable();
  // The phase is of the tick before, so the drive has been given one standing setpoint under torque.
  if (state_.fault != FaultCode::kNone && state_.axis.phase == AxisPhase::kAtRest) end_fault_reaction();
  enable_if_asked();
  // In a fault nothing new starts, not even what was planned before it.
  const Signal setpoint = axis_->tick(commit_ && state_.fault == FaultCode::kNone);
  told_enabled_ = state_.enabled;
  take(servo_->exchange({setpoint, state_.enabled}));
  count_settled(axis_->state());
  publish();
}

void ControlLoop::own_timer_tick() {
  // With ticks coming they obey: filling a line here would hold up the link's bytes.
  if (state_.link_silent) obey_clear_and_disable();
  if (silent_ms_ < kSilentMsAbandon) ++silent_ms_;
  if (silent_ms_ == kSilentMsFault) {
    state_.link_silent = true;
    state_.feedback_valid = false;
    state_.settled_ticks = 0;
    following_ = false;
    if (state_.ticks != 0) ++state_.link_losses;
    if (state_.enabled) raise(FaultCode::kLinkSilent);
  }
  if (silent_ms_ == kSilentMsAbandon && state_.fault != FaultCode::kNone) end_fault_reaction();
  publish();
}

void ControlLoop::obey_clear_and_disable() {
  const uint32_t clear = load(clear_requested_);
  if (clear != cleared_ && !state_.enabled) {
    cleared_ = clear;
    state_.fault = FaultCode::kNone;
  }
  if (load(wanted_enabled_) != 0 || !state_.enabled || state_.fault != FaultCode::kNone) return;
  switch_off(state_.axis.setpoint);
}

void ControlLoop::enable_if_asked() {
  if (load(wanted_enabled_) == 0 || state_.enabled || state_.fault != FaultCode::kNone) return;
  if (!state_.feedback_valid || told_enabled_) return;
  axis_->reset(state_.position);
  missing_in_a_row_ = 0;
  state_.settled_ticks = 0;
  state_.enabled = true;
}

// How many feedbacks are missing between the one before and this. A sequence that stands is a feedback seen already,
// one that goes back is another drive's: its whole past is missing.
uint32_t ControlLoop::lost_before(uint16_t sequence) {
  const auto step = static_cast<uint16_t>(sequence - last_sequence_);
  const bool first = !following_;
  following_ = true;
  last_sequence_ = sequence;
  if (first || step == 1) return 0;
  if (step == 0) return 1;
  return step < 0x8000U ? step - 1U : kMissingInARowFault;
}

void ControlLoop::take(const hal::ServoFeedback& feedback) {
  const bool first = !following_;
  const bool stale = !first && feedback.sequence == last_sequence_;
  const uint32_t lost = lost_before(feedback.sequence);
  const bool usable = feedback.valid && !stale;
  const uint32_t missing = lost + (!usable && !stale ? 1 : 0);
  state_.missing += missing;
  missing_in_a_row_ += missing < kMissingInARowFault ? missing : kMissingInARowFault;
  if (missing_in_a_row_ >= kMissingInARowFault && state_.enabled) raise(FaultCode::kFeedbackMissing);
  commit_ = feedback.commit && !stale;
  if (usable) {
    // Only neighbours tell a velocity; the subtraction wraps, as positions from outside may be anything.
    if (missing_in_a_row_ == 0 && state_.feedback_valid) {
      state_.position_change =
          static_cast<Signal>(static_cast<uint64_t>(feedback.position) - static_cast<uint64_t>(state_.position));
    }
    state_.position = feedback.position;
    acceleration_ = feedback.acceleration;
    missing_in_a_row_ = 0;
  }
  state_.feedback_valid = usable;
}

void ControlLoop::raise(FaultCode fault) {
  if (state_.fault != FaultCode::kNone) return;
  state_.fault = fault;
  axis_->request_stop();
}

void ControlLoop::end_fault_reaction() {
  if (!state_.enabled) return;
  switch_off(axis_->state().setpoint);
}

void ControlLoop::switch_off(Signal position) {
  state_.enabled = false;
  if (state_.link_silent) servo_->disable();
  axis_->reset(position);
}

void ControlLoop::count_settled(const AxisState& axis) {
  const bool settled = state_.enabled && state_.feedback_valid && axis.phase == AxisPhase::kAtRest &&
                       within_counts(state_.position, axis.setpoint, load(window_counts_));
  if (!settled) {
    state_.settled_ticks = 0;
  } else if (state_.settled_ticks != UINT32_MAX) {
    ++state_.settled_ticks;
  }
}

}  // namespace stillpoint::firmware
