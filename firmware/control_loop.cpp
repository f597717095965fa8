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

int32_t saturated(int64_t value) {
  if (value > INT32_MAX) return INT32_MAX;
  return value < INT32_MIN ? INT32_MIN : static_cast<int32_t>(value);
}

}  // namespace

int32_t counts_per_second(Signal change_per_tick, uint32_t ticks_per_second) {
  // Half of the fraction goes before the product, so that it fits at any tick rate up to 65 kHz.
  return saturated((change_per_tick >> 16) * static_cast<int64_t>(ticks_per_second) >> 16);
}

int32_t following_error(const LoopSnapshot& loop) {
  if (!loop.enabled) return 0;
  return saturated(int64_t{counts_from_signal(loop.axis.setpoint)} - counts_from_signal(loop.position));
}

void ControlLoop::begin(AxisCore& axis, hal::ServoPort& servo) {
  axis_ = &axis;
  servo_ = &servo;
  set_fault_option(StopOption::kQuick);
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
  overran_ = overrun_now_;
  overrun_now_ = false;
  obey_clear_and_disable();
  take_requested_fault();
  // The phase is of the tick before, so the drive has been given one standing setpoint under torque.
  if (state_.fault != FaultCode::kNone && state_.axis.phase == AxisPhase::kAtRest) end_fault_reaction();
  enable_if_asked();
  home_if_asked();
  wait_for_ramp();
  // In a fault nothing new starts, not even what was planned before it, but for the ramp that ends it.
  const Signal setpoint = axis_->tick(ramping_ || (commit_ && state_.fault == FaultCode::kNone));
  told_enabled_ = state_.enabled;
  take(servo_->exchange({wrapping_sum(setpoint, home_), state_.enabled}));
  watch_feedback(setpoint);
  count_settled(axis_->state());
  publish();
}

void ControlLoop::note_overrun() {
  ++state_.overruns;
  if (overran_ && state_.enabled) raise(FaultCode::kTickOverrun);
  overrun_now_ = true;
}

void ControlLoop::own_timer_tick() {
  // With ticks coming they obey: filling a line here would hold up the link's bytes.
  if (state_.link_silent) {
    obey_clear_and_disable();
    take_requested_fault();
  }
  watch_client();
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
  feedback_watch_.restart();
  missing_in_a_row_ = 0;
  state_.settled_ticks = 0;
  state_.enabled = true;
}

void ControlLoop::home_if_asked() {
  if (load(home_requested_) == 0 || !state_.enabled || state_.fault != FaultCode::kNone) return;
  if (state_.axis.phase != AxisPhase::kAtRest) return;
  store(home_requested_, 0);
  ++state_.homings;
  const Signal here = signal_from_counts(home_counts_);
  const Signal shift = wrapping_difference(state_.axis.setpoint, here);
  home_ = wrapping_sum(home_, shift);
  state_.position = wrapping_difference(state_.position, shift);
  axis_->reset(here);
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
  neighbours_ = usable && missing_in_a_row_ == 0 && state_.feedback_valid;
  if (usable) {
    const Signal position = wrapping_difference(feedback.position, home_);
    // Only neighbours tell a velocity; the subtraction wraps, as positions from outside may be anything.
    if (neighbours_) state_.position_change = wrapping_difference(position, state_.position);
    state_.position = position;
    acceleration_ = feedback.acceleration;
    missing_in_a_row_ = 0;
  }
  state_.feedback_valid = usable;
}

void ControlLoop::watch_feedback(Signal setpoint) {
  if (!state_.enabled || !state_.feedback_valid || state_.fault != FaultCode::kNone) return;
  const FaultCode fault = feedback_watch_.look(setpoint, state_.position, state_.position_change, neighbours_);
  if (fault != FaultCode::kNone) raise(fault);
}

void ControlLoop::watch_client() {
  const uint32_t heard = load(client_heard_);
  const uint32_t allowed_ms = load(client_watchdog_ms_);
  if (heard != client_seen_ || !state_.enabled || allowed_ms == 0) {
    client_seen_ = heard;
    client_silent_ms_ = 0;
  } else if (++client_silent_ms_ > allowed_ms) {
    client_silent_ms_ = 0;
    raise(FaultCode::kClientSilent);
  }
}

void ControlLoop::take_requested_fault() {
  const uint32_t fault = load(requested_fault_);
  if (fault == 0) return;
  store(requested_fault_, 0);
  raise(static_cast<FaultCode>(fault));
}

// The background's ramp takes over in flight, and the commit it would wait for may never come.
void ControlLoop::wait_for_ramp() {
  if (!awaits_ramp_) return;
  if (load(ramped_fault_) == state_.fault_count) {
    awaits_ramp_ = false;
    ramping_ = true;
  } else if (++ramp_ticks_ > kRampPatienceTicks) {
    awaits_ramp_ = false;
    axis_->request_stop();
  }
}

void ControlLoop::raise(FaultCode fault) {
  if (state_.fault != FaultCode::kNone) return;
  state_.fault = fault;
  ++state_.fault_count;
  if (!state_.enabled) return;
  switch (static_cast<StopOption>(load(fault_option_))) {
    case StopOption::kOff: return end_fault_reaction();
    case StopOption::kRamp:
      awaits_ramp_ = !state_.link_silent;
      ramp_ticks_ = 0;
      if (awaits_ramp_) return;
      break;
    default: break;
  }
  axis_->request_stop();
}

void ControlLoop::end_fault_reaction() {
  if (!state_.enabled) return;
  switch_off(axis_->state().setpoint);
}

void ControlLoop::switch_off(Signal position) {
  state_.enabled = false;
  awaits_ramp_ = false;
  ramping_ = false;
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
