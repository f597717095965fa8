// SPDX-License-Identifier: Apache-2.0
#include "firmware/shaper_settings.hpp"

#include "firmware/register_units.hpp"

namespace stillpoint::firmware {
namespace {

constexpr ModeField kFields[] = {ModeField::kFrequency, ModeField::kDamping, ModeField::kTolerance, ModeField::kKind,
                                 ModeField::kSpacing};
enum : uint32_t { kFrequency, kDamping, kTolerance, kKind, kSpacing };  // their places in kFields

constexpr double kFrequencyPerHz = 1e4;
constexpr double kDampingPerOne = 1e5;
constexpr double kTolerancePerOne = 1e4;
constexpr double kSpacingPerPeriod = 1e4;
constexpr double kUsPerSecond = 1e6;

// Register values are ShaperKind's. A train of the client's own has no registers to come through.
ShaperSpec spec_of(const uint32_t (&fields)[5]) {
  const Mode mode{fields[kFrequency] / kFrequencyPerHz, fields[kDamping] / kDampingPerOne};
  return {static_cast<ShaperKind>(fields[kKind]), mode, fields[kTolerance] / kTolerancePerOne,
          fields[kSpacing] / kSpacingPerPeriod, nullptr};
}

bool same(const ShaperDesign& a, const ShaperDesign& b) {
  if (a.stage_count != b.stage_count || a.tap_count != b.tap_count) return false;
  for (uint32_t i = 0; i < a.stage_count; ++i) {
    if (a.stages[i].first_tap != b.stages[i].first_tap || a.stages[i].tap_count != b.stages[i].tap_count) return false;
  }
  for (uint32_t i = 0; i < a.tap_count; ++i) {
    if (a.taps[i].delay_ticks != b.taps[i].delay_ticks || a.taps[i].gain != b.taps[i].gain) return false;
  }
  return true;
}

}  // namespace

void ShaperSettings::begin(AxisCore& axis, Parameters& parameters) {
  axis_ = &axis;
  parameters_ = &parameters;
  wanted_ = axis.shaper();
  show_in_force();
}

void ShaperSettings::request_apply(Retune when) {
  apply_requested_ = true;
  when_ = when;
  parameters_->set(Register::kShaperState, static_cast<uint32_t>(ShaperState::kPending));
  parameters_->set(Register::kShaperRefusal, 0);
}

void ShaperSettings::discard() {
  apply_requested_ = false;
  if (!axis_->pending()) waiting_ = false;
  write_staged(in_force_);
  if (!waiting_) show_in_force();
}

void ShaperSettings::service() {
  if (apply_requested_) start_apply();
  axis_->service();
  if (!waiting_ || axis_->pending()) return;
  if (same(axis_->shaper(), wanted_)) {
    finish();
  } else {
    hand_over();
  }
}

void ShaperSettings::start_apply() {
  apply_requested_ = false;
  const Staged staged = read_staged();
  ShaperDesign designed = {};
  uint32_t failed_mode = 0;
  const Status status = design(staged, designed, failed_mode);
  if (!status.ok()) {
    refuse_design(status, failed_mode);
    return;
  }
  wanted_ = designed;
  wanted_registers_ = staged;
  waiting_ = true;
}

Status ShaperSettings::design(const Staged& staged, ShaperDesign& out, uint32_t& failed_mode) const {
  for (uint32_t k = 0; k < staged.count; ++k) {
    const Status status = add_shaper(spec_of(staged.fields[k]), axis_->config().tick_s, out);
    if (!status.ok()) {
      failed_mode = k;
      return status;
    }
  }
  return kOk;
}

void ShaperSettings::hand_over() {
  const Status status = axis_->set_shaper(wanted_, when_);
  if (status.ok() || status.error == Error::kBusy) return;  // busy: asked again later
  waiting_ = false;
  refuse_length(status);
}

void ShaperSettings::finish() {
  waiting_ = false;
  in_force_ = wanted_registers_;
  show_in_force();
}

void ShaperSettings::show_in_force() {
  const ShaperDesign active = axis_->shaper();
  const ShaperState state = active.stage_count == 0 ? ShaperState::kOff : ShaperState::kActive;
  const double delay_us = active.delay_ticks() * axis_->config().tick_s * kUsPerSecond;
  parameters_->set(Register::kShaperState, static_cast<uint32_t>(state));
  parameters_->set(Register::kShaperRefusal, 0);
  parameters_->set(Register::kActiveDelayUs, register_floor(delay_us + 0.5));
}

void ShaperSettings::refuse_design(const Status& status, uint32_t mode) {
  Register culprit = Register::kModeCount;
  uint32_t accepted = 0;
  if (status.quantity == Quantity::kFrequency) {
    culprit = mode_register(mode, ModeField::kFrequency);
    const double frequency = status.accepted * kFrequencyPerHz;
    accepted = status.error == Error::kAboveMaximum ? register_floor(frequency) : register_ceiling(frequency);
  } else if (status.quantity == Quantity::kDampingRatio) {
    culprit = mode_register(mode, ModeField::kDamping);
    accepted = register_floor(status.accepted * kDampingPerOne);
  } else if (status.quantity == Quantity::kTolerance) {
    culprit = mode_register(mode, ModeField::kTolerance);
    accepted = register_floor(status.accepted * kTolerancePerOne);
  } else if (status.quantity == Quantity::kSpacing) {
    culprit = mode_register(mode, ModeField::kSpacing);
    accepted = register_floor(status.accepted * kSpacingPerPeriod);
  } else if (status.quantity == Quantity::kStages || status.quantity == Quantity::kTaps) {
    accepted = mode;  // as many modes as went in
  }
  const uint16_t reason = reason_of(status.error, status.quantity);
  parameters_->set(Register::kShaperState, static_cast<uint32_t>(ShaperState::kRefused));
  parameters_->set(Register::kShaperRefusal, reason);
  parameters_->note_refusal(reason, address_of(culprit), accepted);
}

// The axis counts memory; a client knows frequencies. Only a single mode can be told which one would fit.
void ShaperSettings::refuse_length(const Status& status) {
  Register culprit = Register::kModeCount;
  uint32_t accepted = 0;
  if (wanted_registers_.count == 1 && status.error == Error::kLineTooShort && status.accepted >= 1.0) {
    const auto& fields = wanted_registers_.fields[0];
    const size_t line = Shaper::line_room(wanted_, static_cast<size_t>(status.accepted));
    const double lowest = lowest_frequency_hz(spec_of(fields), axis_->config().tick_s, line);
    culprit = mode_register(0, ModeField::kFrequency);
    accepted = register_ceiling(lowest * kFrequencyPerHz);
  }
  const uint16_t reason = reason_of(status.error, status.quantity);
  parameters_->set(Register::kShaperState, static_cast<uint32_t>(ShaperState::kRefused));
  parameters_->set(Register::kShaperRefusal, reason);
  parameters_->note_refusal(reason, address_of(culprit), accepted);
}

ShaperSettings::Staged ShaperSettings::read_staged() const {
  Staged staged = {};
  staged.count = parameters_->get(Register::kModeCount);
  for (uint32_t k = 0; k < kMaxModes; ++k) {
    for (uint32_t f = 0; f < kFieldCount; ++f) staged.fields[k][f] = parameters_->get(mode_register(k, kFields[f]));
  }
  return staged;
}

void ShaperSettings::write_staged(const Staged& staged) {
  parameters_->set(Register::kModeCount, staged.count);
  for (uint32_t k = 0; k < kMaxModes; ++k) {
    for (uint32_t f = 0; f < kFieldCount; ++f) parameters_->set(mode_register(k, kFields[f]), staged.fields[k][f]);
  }
}

}  // namespace stillpoint::firmware
