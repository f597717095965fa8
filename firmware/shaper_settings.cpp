// SPDX-License-Identifier: Apache-2.0
#include "firmware/shaper_settings.hpp"

#include "firmware/register_units.hpp"

namespace stillpoint::firmware {
namespace {

constexpr ModeField kFields[] = {ModeField::kFrequency, ModeField::kDamping, ModeField::kTolerance, ModeField::kKind,
                                 ModeField::kSpacing};
enum : uint32_t { kFrequency, kDamping, kTolerance, kKind, kSpacing };  // their places in kFields

constexpr double kUsPerSecond = 1e6;

// Register values are ShaperKind's. A train of the client's own has no registers to come through.
ShaperSpec spec_of(const uint32_t (&fields)[5]) {
  const Mode mode{fields[kFrequency] / kFrequencyPerHz, fields[kDamping] / kDampingPerOne};
  return {static_cast<ShaperKind>(fields[kKind]), mode, fields[kTolerance] / kResidualPerOne,
          fields[kSpacing] / kSpacingPerPeriod, nullptr};
}

// Or it is a place left empty.
bool shapes_by(const uint32_t (&fields)[5]) { return static_cast<ShaperKind>(fields[kKind]) != ShaperKind::kNone; }

void write_fields(const ShaperSpec& spec, uint32_t (&fields)[5]) {
  fields[kFrequency] = register_nearest(spec.mode.frequency_hz, kFrequencyPerHz);
  fields[kDamping] = register_nearest(spec.mode.damping_ratio, kDampingPerOne);
  fields[kTolerance] = register_nearest(spec.tolerance, kResidualPerOne);
  fields[kKind] = static_cast<uint32_t>(spec.kind);
  fields[kSpacing] = register_nearest(spec.spacing, kSpacingPerPeriod);
}

}  // namespace

void ShaperSettings::begin(AxisCore& axis, Parameters& parameters, const Meanwhile& meanwhile) {
  axis_ = &axis;
  parameters_ = &parameters;
  meanwhile_ = meanwhile;
  show_in_force();
}

void ShaperSettings::show_set(uint32_t set) {
  if (set == shown_) return;
  sets_[shown_].staged = read_staged();
  write_staged(sets_[set].staged);
  shown_ = set;
}

[[gnu::noinline]] ShaperSettings::Place ShaperSettings::place_of(Register name) {
  if (name == Register::kModeCount) return {0, kFieldCount};
  const uint32_t offset = static_cast<uint32_t>(address_of(name) - address_of(Register::kFirstMode));
  uint32_t field = 0;
  while (field + 1 < kFieldCount && static_cast<uint32_t>(kFields[field]) != offset % kModeStride) ++field;
  return {offset / kModeStride, field};
}

uint32_t ShaperSettings::staged(uint32_t set, Register name) const {
  if (set == shown_) return parameters_->get(name);
  const Place place = place_of(name);
  const Staged& staged = set == kSetInForce ? sets_[set_in_force_].in_force : sets_[set].staged;
  return place.field == kFieldCount ? staged.count : staged.fields[place.mode][place.field];
}

void ShaperSettings::stage(uint32_t set, Register name, uint32_t value) {
  if (set == shown_) return parameters_->set(name, value);
  const Place place = place_of(name);
  Staged& staged = set == kSetInForce ? requested_ : sets_[set].staged;
  (place.field == kFieldCount ? staged.count : staged.fields[place.mode][place.field]) = value;
}

void ShaperSettings::request_apply(Retune when) {
  const Staged wanted = read_staged();
  if (shown_ != set_in_force_) drop_followed();
  following_ = false;
  request(shown_, wanted, when);
}

ShaperSettings::Staged ShaperSettings::staged_of(uint32_t set) const {
  return set == shown_ ? read_staged() : sets_[set].staged;
}

// What the client has staged since stays.
void ShaperSettings::drop_followed() {
  if (!following_) return;
  following_ = false;
  if (same(staged_of(set_in_force_), requested_)) stage_set(set_in_force_, sets_[set_in_force_].in_force);
}

void ShaperSettings::restore(uint32_t set) {
  restoring_ = requested_.count != 0;
  if (!restoring_) return;
  set_in_force_ = set;
  sets_[set].in_force = requested_;
  request(set, requested_, Retune::kAtRest);
}

void ShaperSettings::take_off() {
  following_ = false;
  if (!shapes() && !waiting()) return;
  requested_.count = 0;
  request(set_in_force_, requested_, Retune::kAtRest);
}

void ShaperSettings::request(uint32_t set, const Staged& staged, Retune when) {
  designing_ = false;
  apply_requested_ = true;
  requested_set_ = set;
  requested_ = staged;
  requested_when_ = when;
  parameters_->set(Register::kShaperState, static_cast<uint32_t>(ShaperState::kPending));
  parameters_->set(Register::kShaperRefusal, 0);
}

uint32_t ShaperSettings::modes_in_force(Mode* modes) const {
  const Staged& made_for = sets_[set_in_force_].in_force;
  uint32_t count = 0;
  if (restoring_) return count;
  for (uint32_t k = 0; k < made_for.count; ++k) {
    if (shapes_by(made_for.fields[k])) modes[count++] = spec_of(made_for.fields[k]).mode;
  }
  return count;
}

void ShaperSettings::follow(double worthwhile) {
  const Set& set = sets_[set_in_force_];
  Staged staged = staged_of(set_in_force_);
  if (restoring_ || waiting() || !same(staged, set.in_force)) return;
  uint32_t tracked = 0;
  for (uint32_t k = 0; k < staged.count; ++k) {
    if (!shapes_by(staged.fields[k])) continue;
    staged.fields[k][kFrequency] = parameters_->get(tracked_register(tracked, 0));
    staged.fields[k][kDamping] = parameters_->get(tracked_register(tracked++, kTrackedDamping));
  }
  const ShaperDesign active = axis_->shaper();
  if (worst_residual(active, staged) - worst_residual(active, set.in_force) <= worthwhile) return;
  following_ = true;
  stage_set(set_in_force_, staged);
  request(set_in_force_, staged, Retune::kAtRest);
}

[[gnu::noinline]] void ShaperSettings::note_change() {
  restoring_ = false;
  ++changes_;
  parameters_->set(Register::kTrackingRefusal, 0);
}

void ShaperSettings::stage_set(uint32_t set, const Staged& staged) {
  sets_[set].staged = staged;
  if (shown_ == set) write_staged(staged);
}

void ShaperSettings::discard() {
  if (!axis_->pending()) drop_followed();
  apply_requested_ = false;
  designing_ = false;
  if (!axis_->pending()) waiting_ = false;
  write_staged(sets_[shown_].in_force);
  if (!waiting_) show_in_force();
}

void ShaperSettings::service() {
  if (apply_requested_) start_apply();
  if (apply_requested_) return;  // overtaken in its design
  axis_->service();
  if (!waiting_ || axis_->pending()) return;
  if (prepared_.in_force(*axis_) == wanted_set_) {
    finish();
  } else {
    hand_over();
  }
}

void ShaperSettings::start_apply() {
  const uint32_t set = requested_set_;
  const Staged staged = requested_;
  const Retune when = requested_when_;
  apply_requested_ = false;
  designing_ = true;
  const bool ready = prepare(set, staged);
  if (!ready || !designing_) return;
  designing_ = false;
  wanted_set_ = set;
  when_ = when;
  waiting_ = true;
}

// False where it is refused or, `designing_` being false, given up.
bool ShaperSettings::prepare(uint32_t set, const Staged& staged) {
  if (prepared_.stored(set) && same(sets_[set].designed, staged)) return true;
  ShaperDesign design = {};
  for (uint32_t k = 0; k < staged.count; ++k) {
    const Status status = add_shaper(spec_of(staged.fields[k]), axis_->config().tick_s, design, nullptr, meanwhile_);
    if (!designing_) return false;
    if (status.ok()) continue;
    designing_ = false;
    refuse_design(status, k);
    return false;
  }
  sets_[set].designed = staged;
  return prepared_.store(set, design).ok();
}

void ShaperSettings::hand_over() {
  const Status status = prepared_.select(wanted_set_, *axis_, when_);
  if (status.ok() || status.error == Error::kBusy) return;  // busy: asked again later
  waiting_ = false;
  refuse_length(status);
}

void ShaperSettings::finish() {
  waiting_ = false;
  adopted_ = false;
  if (!following_) note_change();
  following_ = false;
  set_in_force_ = wanted_set_;
  sets_[wanted_set_].in_force = sets_[wanted_set_].designed;
  show_in_force();
}

void ShaperSettings::adopt(const ShaperSpec* specs, uint32_t count) {
  Staged staged = {};
  staged.count = count < kMaxModes ? count : kMaxModes;
  for (uint32_t k = 0; k < staged.count; ++k) write_fields(specs[k], staged.fields[k]);
  before_ = sets_[set_in_force_].in_force;
  was_restoring_ = restoring_;
  take_over(staged, false);
  adopted_ = true;
}

void ShaperSettings::give_back() {
  take_over(before_, was_restoring_);
  adopted_ = false;
}

// The design is the one that runs, not one made again from registers, which are rounded.
void ShaperSettings::take_over(const Staged& staged, bool restoring) {
  Set& set = sets_[set_in_force_];
  set.designed = staged;
  set.in_force = staged;
  stage_set(set_in_force_, staged);
  note_change();
  restoring_ = restoring;
  if (restoring) set.designed.count = 0;  // none runs
  (void)prepared_.store(set_in_force_, axis_->shaper());
  show_in_force();
}

void ShaperSettings::show_in_force() {
  const ShaperDesign active = axis_->shaper();
  const ShaperState state = active.stage_count == 0 ? ShaperState::kOff : ShaperState::kActive;
  const double delay_s = active.delay_ticks() * axis_->config().tick_s;
  const double worst = restoring_ ? 0.0 : worst_residual(active, sets_[set_in_force_].in_force);
  const uint32_t residual = register_nearest(worst, kResidualPerOne);
  parameters_->set(Register::kShaperState, static_cast<uint32_t>(state));
  parameters_->set(Register::kShaperRefusal, 0);
  parameters_->set(Register::kActiveDelayUs, register_nearest(delay_s, kUsPerSecond));
  parameters_->set(Register::kPredictedResidual, residual < UINT16_MAX ? residual : UINT16_MAX);
}

double ShaperSettings::worst_residual(const ShaperDesign& active, const Staged& modes) const {
  const Cascade cascade = active.cascade();
  double worst = 0.0;
  for (uint32_t k = 0; k < modes.count; ++k) {
    const ShaperSpec spec = spec_of(modes.fields[k]);
    if (spec.kind == ShaperKind::kNone) continue;
    const double left = residual(cascade, spec.mode.frequency_hz * axis_->config().tick_s, spec.mode.damping_ratio);
    if (left > worst) worst = left;
  }
  return worst;
}

void ShaperSettings::refuse_design(const Status& status, uint32_t mode) {
  Register culprit = Register::kModeCount;
  uint32_t accepted = 0;
  const auto name = [&](ModeField field, double per_unit) {
    const double nearest = status.accepted * per_unit;
    culprit = mode_register(mode, field);
    accepted = status.error == Error::kBelowMinimum ? register_ceiling(nearest) : register_floor(nearest);
  };
  if (status.quantity == Quantity::kFrequency) {
    name(ModeField::kFrequency, kFrequencyPerHz);
  } else if (status.quantity == Quantity::kDampingRatio) {
    name(ModeField::kDamping, kDampingPerOne);
  } else if (status.quantity == Quantity::kTolerance) {
    name(ModeField::kTolerance, kResidualPerOne);
  } else if (status.quantity == Quantity::kSpacing) {
    name(ModeField::kSpacing, kSpacingPerPeriod);
  } else if (status.quantity == Quantity::kStages || status.quantity == Quantity::kTaps) {
    accepted = mode;  // as many modes as went in
  }
  refuse(reason_of(status.error, status.quantity), culprit, accepted);
}

// The axis counts memory; a client knows frequencies. Only a single mode can be told which one would fit.
void ShaperSettings::refuse_length(const Status& status) {
  Register culprit = Register::kModeCount;
  uint32_t accepted = 0;
  const Staged& wanted = sets_[wanted_set_].designed;
  if (wanted.count == 1 && status.error == Error::kLineTooShort && status.accepted >= 1.0) {
    const auto& fields = wanted.fields[0];
    const size_t line = Shaper::line_room(prepared_.design(wanted_set_), static_cast<size_t>(status.accepted));
    const double lowest = lowest_frequency_hz(spec_of(fields), axis_->config().tick_s, line);
    culprit = mode_register(0, ModeField::kFrequency);
    accepted = register_ceiling(lowest * kFrequencyPerHz);
  }
  refuse(reason_of(status.error, status.quantity), culprit, accepted);
}

void ShaperSettings::refuse(uint16_t reason, Register culprit, uint32_t accepted) {
  if (following_) {
    parameters_->set(Register::kTrackingRefusal, reason);
    drop_followed();
    return show_in_force();
  }
  parameters_->set(Register::kShaperState, static_cast<uint32_t>(ShaperState::kRefused));
  parameters_->set(Register::kShaperRefusal, reason);
  parameters_->note_refusal(reason, address_of(culprit), accepted);
}

bool ShaperSettings::same(const Staged& a, const Staged& b) {
  if (a.count != b.count) return false;
  for (uint32_t k = 0; k < a.count; ++k) {
    for (uint32_t f = 0; f < kFieldCount; ++f) {
      if (a.fields[k][f] != b.fields[k][f]) return false;
    }
  }
  return true;
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
