// SPDX-License-Identifier: Apache-2.0
#include "firmware/tuning.hpp"

#include "firmware/register_units.hpp"
#include "firmware/set_point.hpp"

namespace stillpoint::firmware {
namespace {

constexpr double kThousandth = 1e3;
constexpr double kPercent = 1e2;
constexpr double kMsPerSecond = 1e3;
constexpr double kUsPerSecond = 1e6;

// Where the move goes: upwards unless it would pass a soft limit that it would not pass downwards. The furthest whole
// count within `amplitude`, as an axis may stand between two.
double target_of(const AxisConfig& config, Signal from, double amplitude) {
  const double above = static_cast<double>(from >> kSignalFractionBits) + amplitude;
  const double below = static_cast<double>(wrapping_sum(from, kSignalPerCount - 1) >> kSignalFractionBits) - amplitude;
  const bool turns = config.has_soft_limits() && above > config.soft_high_counts && below >= config.soft_low_counts;
  return turns ? below : above;
}

}  // namespace

bool TuneSettings::command(TuneCommand command, const Parameters& staged, uint32_t now_ms) {
  Parameters& parameters = *parts_.parameters;
  const uint16_t reason = reason_against(command);
  if (reason != 0) {
    parameters.note_refusal(reason, address_of(Register::kTuneCommand));
    return false;
  }
  Status status = kOk;
  switch (command) {
    case TuneCommand::kStart: status = start(staged, now_ms); break;
    case TuneCommand::kAbort:
      leading_ = false;
      parts_.tuner->abort();
      break;
    case TuneCommand::kAccept: status = parts_.tuner->accept(); break;
    case TuneCommand::kUndo:
      undoing_ = parts_.tuner->report().state == TuneState::kKept;
      status = parts_.tuner->undo();
      running_ = true;
      break;
  }
  if (!status.ok()) refuse_start(status);
  return status.ok();
}

uint16_t TuneSettings::reason_against(TuneCommand command) const {
  const TuneState state = parts_.tuner->report().state;
  const bool busy = parts_.tuner->busy();
  const bool undoes_kept = command == TuneCommand::kUndo && state == TuneState::kKept;
  if (command == TuneCommand::kAbort) return 0;
  if (command == TuneCommand::kStart && busy) return kReasonTuning;
  if (command != TuneCommand::kStart && !undoes_kept) return state == TuneState::kProposed ? 0 : kReasonNothingToDo;
  if (undoes_kept && !parts_.shaper->adopted()) return kReasonNothingToDo;
  // From here on the axis is needed.
  const uint16_t reason = parts_.drive->reason_not_free();
  if (reason != 0) return reason;
  return parts_.shaper->waiting() ? kReasonNotStanding : 0;
}

Status TuneSettings::start(const Parameters& staged, uint32_t now_ms) {
  const Signal from = parts_.drive->loop().axis.demand;
  from_counts_ = counts_from_signal(from);
  const double amplitude = staged.get(Register::kTuneAmplitude);
  const double target = target_of(parts_.axis->config(), from, amplitude);
  const double room = target > from_counts_ ? kMaxPositionCounts - from_counts_ : from_counts_ - kMinPositionCounts;
  if (amplitude > room) return refuse(Error::kAboveMaximum, Quantity::kAmplitude, amplitude, room);
  TuneConfig config = {};
  config.excitation = static_cast<TuneExcitation>(staged.get(Register::kTuneExcitation));
  config.source = static_cast<TuneSource>(staged.get(Register::kTuneSourceWanted));
  const Status status = make_move(staged, false, 0, config.move);
  if (!status.ok()) return status;
  config.move.target_counts = static_cast<int32_t>(target);
  config.move.duration_s = 0.0;
  config.amplitude_counts = amplitude;
  config.travel_counts = staged.get(Register::kTuneTravel);
  config.low_hz = staged.get(Register::kTuneBandLow) / kBandPerHz;
  low_hz_ = config.low_hz;
  config.high_hz = staged.get(Register::kTuneBandHigh) / kBandPerHz;
  config.tolerance = staged.get(Register::kTuneTolerance) / kResidualPerOne;
  config.sensor_lowest = staged.get_signed(Register::kTuneSensorLowest);
  config.sensor_highest = staged.get_signed(Register::kTuneSensorHighest);
  config.accept_by_itself = staged.get(Register::kTuneByItself) != 0;
  const Status started = parts_.tuner->start(config, nullptr);
  if (!started.ok()) return started;
  leading_ = true;
  started_ms_ = now_ms;
  running_ = true;
  undoing_ = false;
  by_sine_ = parts_.tuner->report().excited_by > TuneExcitation::kBump;
  return kOk;
}

void TuneSettings::refuse_start(const Status& status) {
  Register culprit = Register::kTuneCommand;
  double per_unit = 1.0;
  double nearest = status.accepted;
  switch (status.quantity) {
    case Quantity::kTravel:  // what the move needs, above what there is
    case Quantity::kDistance:
    case Quantity::kAmplitude: culprit = Register::kTuneAmplitude; break;
    case Quantity::kPosition:
      culprit = Register::kTuneAmplitude;
      nearest = nearest > from_counts_ ? nearest - from_counts_ : from_counts_ - nearest;
      break;
    case Quantity::kKind: culprit = Register::kTuneExcitation; break;
    case Quantity::kFrequency:
      culprit = status.value == low_hz_ ? Register::kTuneBandLow : Register::kTuneBandHigh;
      per_unit = kBandPerHz;
      break;
    case Quantity::kTolerance:
      culprit = Register::kTuneTolerance;
      per_unit = kResidualPerOne;
      break;
    case Quantity::kVelocity:
    case Quantity::kAcceleration:
    case Quantity::kDeceleration:
    case Quantity::kJerk:
    case Quantity::kDecelerationJerk:
      // A limit that would be exceeded has a duration, which a tuning does not take.
      if (status.error == Error::kLimitExceeded) break;
      note_move_refusal(status, *parts_.parameters);
      return;
    default: break;
  }
  uint32_t accepted = 0;
  if (culprit != Register::kTuneCommand) {
    nearest *= per_unit;
    accepted = status.error == Error::kBelowMinimum ? register_ceiling(nearest) : register_floor(nearest);
  }
  parts_.parameters->note_refusal(reason_of(status.error, status.quantity), address_of(culprit), accepted);
}

void TuneSettings::keep_watch() {
  if (!busy()) aborted_ = false;
  if (!busy() || aborted_ || parts_.drive->may_move()) return;
  aborted_ = true;
  leading_ = false;
  parts_.tuner->abort();
}

void TuneSettings::service(uint32_t now_ms, const Meanwhile& meanwhile) {
  if (!available()) return;
  if (leading_ && now_ms - started_ms_ < parts_.parameters->get(Register::kTuneLeadMs)) return;
  leading_ = false;
  parts_.tuner->service(meanwhile);
  const TuneReport& report = parts_.tuner->report();
  if (report.state != seen_) parts_.shaper->show_in_force();
  seen_ = report.state;
  if (!by_sine_ && report.excited_by > TuneExcitation::kBump) {
    by_sine_ = leading_ = true;
    started_ms_ = now_ms;
  }
  if (!running_ || parts_.tuner->busy()) return;
  running_ = false;
  finish(report);
}

void TuneSettings::finish(const TuneReport& report) {
  const bool kept = report.state == TuneState::kKept;
  if (undoing_ && !kept) parts_.shaper->give_back();
  if (!undoing_ && kept) parts_.shaper->adopt(report.proposal.specs, report.proposal.spec_count);
  if (!report.refusal.ok()) refuse_start(report.refusal);
}

// Saturates at what the register holds.
void TuneSettings::set(Register name, double value) {
  const uint32_t most = kParameters[find_parameter(address_of(name))].words() == 2 ? UINT32_MAX : UINT16_MAX;
  const uint32_t whole = register_nearest(value, 1.0);
  parts_.parameters->set(name, whole < most ? whole : most);
}

void TuneSettings::show() {
  if (!available()) return;
  const TuneReport& report = parts_.tuner->report();
  Parameters& parameters = *parts_.parameters;
  clear_shown();
  parameters.set(Register::kTuneState, static_cast<uint32_t>(report.state));
  parameters.set(Register::kTuneProgress, report.progress_percent);
  parameters.set(Register::kTuneExcitedBy, static_cast<uint32_t>(report.excited_by));
  set(Register::kTuneTravelAnnounced, report.announced.travel);
  set(Register::kTuneVelocityAnnounced, report.announced.velocity);
  set(Register::kTuneAccelerationAnnounced, report.announced.acceleration);
  set(Register::kTuneJerkAnnounced, report.announced.jerk / kJerkUnit);
  set(Register::kTuneDurationMs, report.announced.duration_s * kMsPerSecond);
  // While it is being worked out, what there is of it is no answer.
  if (report.state >= TuneState::kProposed) show_result(report);
}

void TuneSettings::clear_shown() {
  const size_t end = find_parameter(address_of(Register::kTuneExcitedBy));
  for (size_t i = find_parameter(address_of(Register::kTuneState)); i < end; ++i) {
    if (!kParameters[i].writable()) parts_.parameters->set_value(i, 0);
  }
}

void TuneSettings::show_result(const TuneReport& report) {
  Parameters& parameters = *parts_.parameters;
  parameters.set(Register::kTuneResult, static_cast<uint32_t>(report.identification.finding));
  parameters.set(Register::kTuneSourceUsed, static_cast<uint32_t>(report.source));
  parameters.set(Register::kTuneSourceEnough, report.source_enough ? 1 : 0);
  parameters.set(Register::kTuneGaps, report.flaws.gaps);
  parameters.set(Register::kTuneSaturated, report.flaws.saturated);
  set(Register::kTuneResidual, report.proposal.residual * kResidualPerOne);
  set(Register::kTuneDelayUs, report.proposal.delay_s * kUsPerSecond);
  set(Register::kTuneLengthUs, report.proposal.length_s * kUsPerSecond);
  set(Register::kTunePlainRinging, report.plain_ringing * kThousandth);
  set(Register::kTuneShapedRinging, report.shaped_ringing * kThousandth);
  show_modes(report);
}

void TuneSettings::show_modes(const TuneReport& report) {
  const Identification& identification = report.identification;
  parts_.parameters->set(Register::kTuneModeCount, static_cast<uint32_t>(identification.mode_count));
  for (uint32_t k = 0; k < identification.mode_count; ++k) {
    const IdentifiedMode& mode = identification.mode[k];
    set(found_register(k, FoundField::kFrequency), mode.frequency_hz * kFrequencyPerHz);
    set(found_register(k, FoundField::kDamping), mode.damping_ratio * kDampingPerOne);
    set(found_register(k, FoundField::kAmplitude), mode.amplitude / identification.mode[0].amplitude * kThousandth);
    set(found_register(k, FoundField::kFrequencyStd), mode.frequency_std_hz * kFrequencyPerHz);
    set(found_register(k, FoundField::kDampingStd), mode.damping_std * kDampingPerOne);
    set(found_register(k, FoundField::kConfidence), mode.confidence * kPercent);
  }
}

}  // namespace stillpoint::firmware
