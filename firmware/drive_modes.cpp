// SPDX-License-Identifier: Apache-2.0
// What the drive does in operation enabled: its modes.
#include "firmware/drive.hpp"
#include "firmware/set_point.hpp"

namespace stillpoint::firmware {

void Drive::write_velocity() { velocity_waits_ = state_ == DriveState::kOperationEnabled; }

void Drive::follow_mode() {
  if (seen_.homings != homings_) {
    homings_ = seen_.homings;
    homing_ = false;
    homed_ = true;
  }
  const auto wanted = static_cast<OperationMode>(parameters_->get(Register::kMode));
  if (wanted == mode_ || !standing_ || homing_ || tuning_) return;
  mode_ = wanted;
  parameters_->set(Register::kModeDisplay, static_cast<uint32_t>(wanted));
  if (set_point_waits_ || buffered_) parameters_->note_refusal(kReasonOtherMode, address_of(Register::kMode));
  start_mode();
}

// Nothing of an earlier mode, or of an earlier time in this one, goes on.
void Drive::start_mode() {
  forget_commands();
  stream_->stop();
  homed_ = false;
  homing_failed_ = false;
}

void Drive::forget_commands() {
  set_point_waits_ = false;
  set_point_taken_ = false;
  buffered_ = false;
  velocity_ = 0;
  velocity_waits_ = false;
  parameters_->set(Register::kTargetVelocity, 0);
}

void Drive::take_set_point(bool shaper_waiting) {
  if (state_ != DriveState::kOperationEnabled || slowing_ || tuning_ || (shaper_waiting && !moving_)) return;
  if (mode_ == OperationMode::kProfileVelocity) return take_velocity();
  if (buffered_ && standing_) {
    buffered_ = false;
    if (!start(next_)) set_point_taken_ = false;
    return;
  }
  if (!set_point_waits_) return;
  set_point_waits_ = false;
  if (halt_asked()) return parameters_->note_refusal(kReasonHalted, address_of(Register::kControlword));
  if (mode_ == OperationMode::kHoming) return home();
  if (mode_ == OperationMode::kStream) return begin_stream();
  take_target();
}

void Drive::home() {
  homed_ = false;
  homing_failed_ = !standing_;
  if (homing_failed_) return parameters_->note_refusal(kReasonNotStanding, address_of(Register::kControlword));
  homing_ = true;
  loop_->request_home(0);
}

void Drive::begin_stream() {
  int32_t first = 0;
  if (!standing_) return parameters_->note_refusal(kReasonNotStanding, address_of(Register::kControlword));
  if (!stream_->first(first)) return parameters_->note_refusal(kReasonStreamEmpty, kFirstStreamPosition);
  const int32_t stands = counts_from_signal(seen_.axis.setpoint);
  if (first != stands) {
    return parameters_->note_refusal(kReasonStreamEmpty, kFirstStreamPosition, static_cast<uint32_t>(stands));
  }
  // An interval of the shortest: a position that comes a tick late is made up for.
  constexpr uint32_t kMadeUpTicks = 2;
  const auto policy = parameters_->get(Register::kStreamPolicy) != 0 ? StreamPolicy::kFault : StreamPolicy::kClamp;
  stream_->start(first, parameters_->get(Register::kStreamInterval));
  const Status status = axis_->begin_stream({profile_limits(*parameters_), policy, kMadeUpTicks});
  if (!status.ok()) {
    stream_->stop();
    return note_move_refusal(status, *parameters_);
  }
  follow_command();
}

void Drive::follow_stream() {
  if (!stream_->running()) return;
  // A fault where it stood has ended it already. Asked for once: a reset must not find it waiting.
  if (axis_->stream_state().faulted && seen_.fault == FaultCode::kNone) loop_->request_fault(FaultCode::kStreamLimit);
  if (mode_ != OperationMode::kStream || standing_) return stream_->stop();
  if ((controlword_ & kControlNewSetPoint) == 0 && !given_up_) slow_down();
}

void Drive::take_velocity() {
  if (!velocity_waits_ || halt_asked()) return;
  const int32_t wanted = parameters_->get_signed(Register::kTargetVelocity);
  MoveReport report = {};
  const Status status = axis_->jog(wanted, profile_limits(*parameters_), &report);
  if (status.error == Error::kBusy) return;  // what was asked for before has not begun; asked again
  velocity_waits_ = false;
  // On a soft limit, and bound beyond it: that holds it.
  if (status.ok() || (standing_ && status.quantity == Quantity::kPosition)) {
    velocity_ = wanted;
    velocity_change_ = static_cast<Signal>(wanted * axis_->config().tick_s * static_cast<double>(kSignalPerCount));
    at_velocity_ = false;
  }
  if (!status.ok()) return note_velocity_refusal(status, *parameters_);
  note_move_report(report, *parameters_);
  follow_command();
}

// Since that tick, with that setpoint.
void Drive::see_velocity(uint32_t tick, Signal setpoint) {
  constexpr uint32_t kRounding = 1U << 12;  // 1e-6 counts
  const uint32_t ticks = seen_.axis.tick - tick;
  if (ticks == 0) return;
  const Signal change = wrapping_difference(seen_.axis.setpoint, setpoint);
  const uint64_t off = static_cast<uint64_t>(change) - static_cast<uint64_t>(velocity_change_) * ticks;
  at_velocity_ = off + kRounding <= 2 * kRounding;
}

void Drive::take_target() {
  const bool relative = (controlword_ & kControlRelative) != 0;
  const bool at_once = (controlword_ & kControlAtOnce) != 0;
  const Signal from = moving_ && !given_up_ ? signal_from_counts(target_) : seen_.axis.demand;
  Move move = {};
  const Status status = buffered_ && !at_once ? refuse(Error::kBusy) : make_move(*parameters_, relative, from, move);
  if (!status.ok()) return note_move_refusal(status, *parameters_);
  if (standing_ || at_once) {
    set_point_taken_ = start(move);
    if (set_point_taken_) buffered_ = false;
    return;
  }
  next_ = move;
  buffered_ = true;
  set_point_taken_ = true;
}

bool Drive::start(const Move& move) {
  MoveReport report = {};
  const Status status = axis_->command(move, &report);
  if (!status.ok()) {
    note_move_refusal(status, *parameters_);
    return false;
  }
  note_move_report(report, *parameters_);
  target_ = move.target_counts;
  follow_command();
  return true;
}

void Drive::follow_command() {
  moving_ = true;
  given_up_ = false;
  // A fault while this was planned: the loop lets nothing start, and the request must not outlive the fault.
  if (loop_->fault() != FaultCode::kNone) axis_->request_stop();
}

// Halted, or in a quick stop that stays: that it stands.
bool Drive::target_reached() const {
  const bool stops = state_ != DriveState::kOperationEnabled;
  if (stops && (state_ != DriveState::kQuickStopActive || !stays_)) return false;
  if (!stops && !halt_asked()) {
    if (mode_ == OperationMode::kProfileVelocity) {
      if (velocity_ != parameters_->get_signed(Register::kTargetVelocity)) return false;
      if (velocity_ != 0) return at_velocity_;
    } else if (given_up_) {
      return false;
    }
  }
  if (moving_ || buffered_) return false;
  const uint64_t settled_us = uint64_t{seen_.settled_ticks} * tick_us_;
  return seen_.settled_ticks != 0 && settled_us >= uint64_t{parameters_->get(Register::kPositionTimeMs)} * 1000U;
}

uint32_t Drive::mode_bits() const {
  switch (mode_) {
    case OperationMode::kProfileVelocity:
      if (state_ != DriveState::kOperationEnabled || !standing_) return 0;
      return kStatusVelocityZero | (velocity_ != 0 && !moving_ ? kStatusInternalLimit : 0U);
    case OperationMode::kStream:
      return seen_.axis.phase == AxisPhase::kStreaming && !axis_->stream_state().limiting ? kStatusSetPointTaken : 0U;
    case OperationMode::kHoming: return (homed_ ? kStatusHomed : 0U) | (homing_failed_ ? kStatusHomingError : 0U);
    default:
      return (set_point_taken_ || buffered_ ? kStatusSetPointTaken : 0U) |
             (seen_.fault == FaultCode::kFollowingError ? kStatusFollowingError : 0U);
  }
}

}  // namespace stillpoint::firmware
