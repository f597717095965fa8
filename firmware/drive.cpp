// SPDX-License-Identifier: Apache-2.0
// The drive's states, and how it stops.
#include "firmware/drive.hpp"

#include "firmware/set_point.hpp"

namespace stillpoint::firmware {

void Drive::begin(AxisCore& axis, ControlLoop& loop, Parameters& parameters, PositionStream& stream) {
  axis_ = &axis;
  loop_ = &loop;
  parameters_ = &parameters;
  stream_ = &stream;
  tick_us_ = static_cast<uint32_t>(axis.config().tick_s * 1e6 + 0.5);
  mode_ = OperationMode::kProfilePosition;
}

void Drive::write_controlword(uint16_t controlword) {
  const uint32_t rising = controlword & ~uint32_t{controlword_};
  controlword_ = controlword;
  if ((controlword & kControlNewSetPoint) == 0) {
    set_point_waits_ = false;
    set_point_taken_ = false;
  }
  if ((rising & kControlFaultReset) != 0 && state_ == DriveState::kFault) loop_->request_fault_clear();
  // Only in operation enabled: an edge before is lost, so that enabling never starts a move.
  if ((rising & kControlNewSetPoint) != 0 && state_ == DriveState::kOperationEnabled) {
    set_point_waits_ = !tuning_ && mode_ != OperationMode::kProfileVelocity;
    parameters_->note_refusal(tuning_ ? kReasonTuning : 0, tuning_ ? address_of(Register::kControlword) : 0);
  }
  service();
  const bool wants_feedback =
      state_ == DriveState::kSwitchedOn && command_of(controlword) == DriveCommand::kEnableOperation;
  if (wants_feedback && !seen_.feedback_valid) {
    parameters_->note_refusal(kReasonNoFeedback, address_of(Register::kControlword));
  }
}

void Drive::service() {
  // In this order: a tick between the two can then only show a move later than it began, never an end too early.
  const bool pending = axis_->pending();
  const uint32_t tick = seen_.axis.tick;
  const Signal setpoint = seen_.axis.setpoint;
  loop_->snapshot(seen_);
  see_velocity(tick, setpoint);
  standing_ = !pending && seen_.axis.phase == AxisPhase::kAtRest;
  if (standing_) moving_ = false;
  follow_mode();
  follow_stream();
  follow_loop();
  obey();
  loop_->request_enabled(enabling_ || state_ == DriveState::kOperationEnabled ||
                         state_ == DriveState::kQuickStopActive);
}

void Drive::follow_loop() {
  if (seen_.fault != FaultCode::kNone) {
    enter(seen_.enabled ? DriveState::kFaultReaction : DriveState::kFault);
    ramp_for_fault();
    return;
  }
  switch (state_) {
    case DriveState::kNotReady:
      if (tick_us_ != 0) enter(DriveState::kSwitchOnDisabled);
      break;
    case DriveState::kFaultReaction:
    case DriveState::kFault: enter(DriveState::kSwitchOnDisabled); break;
    case DriveState::kSwitchedOn:
      if (enabling_ && seen_.enabled) enter(DriveState::kOperationEnabled);
      break;
    case DriveState::kQuickStopActive:
      if (standing_ && !stays_) enter(DriveState::kSwitchOnDisabled);
      break;
    default: break;
  }
}

void Drive::ramp_for_fault() {
  if (state_ != DriveState::kFaultReaction || ramped_fault_ == seen_.fault_count) return;
  ramped_fault_ = seen_.fault_count;
  if (option(Register::kFaultOption) != StopOption::kRamp) return;
  slow_down();
  loop_->note_ramp(seen_.fault_count);
}

void Drive::obey() {
  const DriveState wanted = next_state(state_, command_of(controlword_));
  if (obey_enable(wanted)) return;
  if (goes_on()) return enter(DriveState::kOperationEnabled);
  if (wanted == state_) {
    if (slowing_) forget_commands();
    slowing_ = false;
    if (state_ == DriveState::kOperationEnabled) obey_halt();
    return;
  }
  if (state_ == DriveState::kOperationEnabled && wanted == DriveState::kSwitchedOn && !standing_) {
    if (!slowing_) slow_down();  // nothing else begins until it stands
    slowing_ = true;
    return;
  }
  if (wanted == DriveState::kQuickStopActive) return quick_stop();
  enter(wanted);
}

void Drive::quick_stop() {
  const StopOption how = option(Register::kQuickStopOption);
  if (how == StopOption::kOff) return enter(DriveState::kSwitchOnDisabled);
  stays_ = how == StopOption::kRampAndStay || how == StopOption::kQuickAndStay;
  if (how == StopOption::kRamp || how == StopOption::kRampAndStay) {
    slow_down();
  } else {
    axis_->request_stop();
    if (moving_) given_up_ = true;
  }
  enter(DriveState::kQuickStopActive);
}

// CiA 402's transition 16: out of a quick stop that stays, once it stands.
bool Drive::goes_on() const {
  return state_ == DriveState::kQuickStopActive && stays_ && standing_ &&
         command_of(controlword_) == DriveCommand::kEnableOperation;
}

// The output stage is asked for only when it is known to be off, or the axis would go on from where it was instead of
// beginning at the actual position.
bool Drive::obey_enable(DriveState wanted) {
  if (state_ != DriveState::kSwitchedOn || wanted != DriveState::kOperationEnabled) {
    enabling_ = false;
    return false;
  }
  if (!seen_.enabled) enabling_ = true;
  return true;
}

void Drive::obey_halt() {
  if (!halt_asked()) {
    halting_ = false;
    return;
  }
  buffered_ = false;
  if (halting_) return;
  halting_ = true;
  if (!standing_) slow_down();
  velocity_ = 0;
  velocity_waits_ = true;  // goes on afterwards
}

StopOption Drive::option(Register name) const { return static_cast<StopOption>(parameters_->get(name)); }

void Drive::slow_down() {
  buffered_ = false;
  if (!axis_->halt(profile_limits(*parameters_), nullptr).ok()) axis_->request_stop();
  if (moving_) given_up_ = true;
}

void Drive::enter(DriveState state) {
  if (state == state_) return;
  state_ = state;
  enabling_ = false;
  slowing_ = false;
  halting_ = false;
  forget_commands();
  loop_->take_home_back();
  homing_ = false;
  if (state == DriveState::kOperationEnabled) {
    stream_->stop();
    moving_ = false;
    given_up_ = false;
  }
}

uint16_t Drive::reason_not_free() const {
  if (state_ != DriveState::kOperationEnabled) return kReasonNotEnabled;
  if (halt_asked()) return kReasonHalted;
  const bool waits = set_point_waits_ || buffered_ || homing_;
  return standing_ && !waits && !velocity_is_asked() ? 0 : kReasonNotStanding;
}

bool Drive::may_move() const {
  return state_ == DriveState::kOperationEnabled && command_of(controlword_) == DriveCommand::kEnableOperation &&
         !halt_asked();
}

uint16_t Drive::statusword() const {
  uint32_t word = status_bits(state_) | kStatusRemote;
  if (!seen_.link_silent && seen_.ticks != 0) word |= kStatusVoltageEnabled;
  if (seen_.link_silent || !seen_.feedback_valid) word |= kStatusWarning;
  if (target_reached()) word |= kStatusTargetReached;
  word |= mode_bits();
  return static_cast<uint16_t>(word);
}

}  // namespace stillpoint::firmware
