// SPDX-License-Identifier: Apache-2.0
#include "firmware/scope.hpp"

#include "firmware/register_units.hpp"
#include "shaper/base/shared.hpp"

namespace stillpoint::firmware {
namespace {

constexpr uint32_t kBlockBits = 8;  // of a page's number

Register channel_register(uint32_t k) { return static_cast<Register>(address_of(Register::kFirstScopeChannel) + k); }

int32_t flags_of(const LoopSnapshot& now) {
  const uint32_t flags = (now.enabled ? kScopeEnabled : 0U) | (now.feedback_valid ? kScopeFeedbackValid : 0U) |
                         (now.settled_ticks != 0 ? kScopeInWindow : 0U);
  return static_cast<int32_t>(flags);
}

}  // namespace

void Scope::begin(TuneMemory* memory, Parameters& parameters, uint32_t ticks_per_second) {
  memory_ = memory;
  parameters_ = &parameters;
  ticks_per_second_ = ticks_per_second;
}

CaptureState Scope::state() const {
  return memory_ != nullptr && memory_->held_by(MemoryHolder::kScope) ? capture_.state() : CaptureState::kIdle;
}

bool Scope::command(ScopeCommand command, const Parameters& staged) {
  const uint16_t reason = reason_against(command);
  if (reason != 0) {
    parameters_->note_refusal(reason, address_of(Register::kScopeCommand));
    return false;
  }
  if (command == ScopeCommand::kTrigger) {
    capture_.trigger();
    return true;
  }
  if (command == ScopeCommand::kStop) {
    stop();
    return true;
  }
  const Status status = start(staged);
  if (status.ok()) return true;
  const Register culprit = channel_register(0);
  const bool no_channel = status.quantity == Quantity::kChannels && status.error == Error::kBelowMinimum;
  parameters_->note_refusal(reason_of(status.error, status.quantity),
                            address_of(no_channel ? culprit : Register::kScopeTriggerChannel),
                            register_floor(status.accepted));
  return false;
}

// The tick looks at nothing here from then on.
void Scope::stop() {
  if (memory_ == nullptr) return;
  memory_->release(MemoryHolder::kScope);
  capture_.stop();
}

uint16_t Scope::reason_against(ScopeCommand command) const {
  if (command == ScopeCommand::kStop) return 0;
  if (memory_ == nullptr) return kReasonNotAvailable;
  if (memory_->held_by(MemoryHolder::kTuning)) return kReasonTuning;
  if (command == ScopeCommand::kTrigger && state() != CaptureState::kWaiting) return kReasonNothingToDo;
  return 0;
}

Status Scope::start(const Parameters& staged) {
  uint32_t channels = 0;
  while (channels < kMaxChannels && staged.get(channel_register(channels)) != 0) ++channels;
  if (channels == 0) return refuse(Error::kBelowMinimum, Quantity::kChannels, 0.0, 1.0);
  const auto trigger = static_cast<ScopeTrigger>(staged.get(Register::kScopeTrigger));
  const uint32_t trigger_channel = staged.get(Register::kScopeTriggerChannel);
  if (trigger == ScopeTrigger::kLevel && trigger_channel >= channels)
    return refuse(Error::kAboveMaximum, Quantity::kChannels, trigger_channel, channels - 1);
  stop();
  trigger_ = trigger;
  trigger_channel_ = trigger_channel;
  channels_ = channels;
  for (uint32_t k = 0; k < channels; ++k) source_[k] = static_cast<ScopeSource>(staged.get(channel_register(k)));
  edge_ = static_cast<ScopeEdge>(staged.get(Register::kScopeEdge));
  level_ = staged.get_signed(Register::kScopeLevel);
  CaptureConfig config;
  config.channels = channels;
  config.samples = static_cast<uint32_t>(TuneMemory::kSamples) / channels;
  config.pre_trigger = config.samples * staged.get(Register::kScopePreTrigger) / 100U;
  config.decimation = staged.get(Register::kScopeDecimation);
  after_ = config.samples - config.pre_trigger;
  has_seen_ = false;
  const Status status = capture_.start(config, memory_->record, TuneMemory::kSamples);
  if (status.ok()) memory_->claim(MemoryHolder::kScope);
  return status;
}

void Scope::show() {
  const CaptureState now = state();
  const uint32_t samples = now == CaptureState::kIdle ? 0 : capture_.samples();
  parameters_->set(Register::kScopeState, static_cast<uint32_t>(now));
  parameters_->set(Register::kScopeSamples, samples);
  parameters_->set(Register::kScopeBefore, now == CaptureState::kFull ? samples - after_ : 0);
}

uint16_t Scope::word(uint32_t offset) const {
  const uint32_t page = parameters_->get(Register::kScopePage);
  const uint32_t channel = page >> kBlockBits;
  const uint32_t n = (page & ((UINT32_C(1) << kBlockBits) - 1)) * kScopePage + offset / 2;
  if (channel >= channels_ || n >= capture_.samples()) return 0;
  const auto value = static_cast<uint32_t>(capture_.value(channel, n));
  return static_cast<uint16_t>(offset % 2 == 0 ? value >> 16 : value);
}

void Scope::tick(const LoopSnapshot& now, const TuneSample& sample) {
  if (memory_ == nullptr || !memory_->held_by(MemoryHolder::kScope)) return;
  if (!has_seen_) {
    seen_.demand = now.axis.demand;
    seen_.setpoint = now.axis.setpoint;
  }
  int32_t values[kMaxChannels] = {};
  for (uint32_t k = 0; k < channels_; ++k) values[k] = value_of(source_[k], now, sample);
  const Seen seen = {now.axis.demand, now.axis.setpoint, values[trigger_channel_], now.fault_count,
                     now.axis.phase != AxisPhase::kAtRest};
  if (has_seen_ && capture_.state() == CaptureState::kWaiting && is_triggered(seen)) capture_.trigger();
  capture_.tick(values, true);
  seen_ = seen;
  has_seen_ = true;
}

bool Scope::is_triggered(const Seen& now) const {
  const bool rises = seen_.level < level_ && now.level >= level_;
  const bool falls = seen_.level > level_ && now.level <= level_;
  switch (trigger_) {
    case ScopeTrigger::kLevel: return (rises && edge_ != ScopeEdge::kFalling) || (falls && edge_ != ScopeEdge::kRising);
    case ScopeTrigger::kMotion: return now.moving && !seen_.moving;
    case ScopeTrigger::kRest: return !now.moving && seen_.moving;
    case ScopeTrigger::kFault: return now.fault_count != seen_.fault_count;
    case ScopeTrigger::kByHand: break;
  }
  return false;
}

int32_t Scope::value_of(ScopeSource source, const LoopSnapshot& now, const TuneSample& sample) const {
  switch (source) {
    case ScopeSource::kDemand: return counts_from_signal(now.axis.demand);
    case ScopeSource::kSetpoint: return counts_from_signal(now.axis.setpoint);
    case ScopeSource::kPosition: return counts_from_signal(now.position);
    case ScopeSource::kFollowingError: return following_error(now);
    case ScopeSource::kDemandVelocity:
      return counts_per_second(wrapping_difference(now.axis.demand, seen_.demand), ticks_per_second_);
    case ScopeSource::kSetpointVelocity:
      return counts_per_second(wrapping_difference(now.axis.setpoint, seen_.setpoint), ticks_per_second_);
    case ScopeSource::kVelocity: return counts_per_second(now.position_change, ticks_per_second_);
    case ScopeSource::kAccelerometer: return sample.acceleration;
    case ScopeSource::kPhase: return static_cast<int32_t>(now.axis.phase);
    case ScopeSource::kFault: return static_cast<int32_t>(now.fault);
    case ScopeSource::kFlags: return flags_of(now);
    case ScopeSource::kNone: break;
  }
  return 0;
}

}  // namespace stillpoint::firmware
