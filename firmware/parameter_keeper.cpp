// SPDX-License-Identifier: Apache-2.0
#include "firmware/parameter_keeper.hpp"

namespace stillpoint::firmware {

void ParameterKeeper::begin(const RegisterBank::Parts& parts, RegisterBank& registers, hal::Nonvolatile* memory,
                            Restart restart) {
  parts_ = parts;
  registers_ = &registers;
  restart_ = restart;
  store_.begin(memory);
  delivered_ = parts.axis->config();
  load();
}

void ParameterKeeper::load() {
  Parameters& parameters = *parts_.parameters;
  const Loaded loaded = store_.load(parameters, *parts_.shaper);
  if (loaded == Loaded::kUnknownVersion || loaded == Loaded::kOlderImage)
    parameters.note_refusal(kReasonImageVersion, 0);
  if (loaded == Loaded::kBad) {
    parameters.note_refusal(kReasonImageBad, 0);
    parts_.loop->request_fault(FaultCode::kParametersBad);
  }
  if (loaded != Loaded::kImage && loaded != Loaded::kOlderImage) return;
  const Register lowered = parameters.lower_to_ceilings();
  if (lowered != kNoRegister) parameters.note_refusal(kReasonOutOfRange, address_of(lowered), parameters.get(lowered));
  const Status status = registers_->take_parameters();
  if (status.ok()) return;
  // Limits that this axis does not take: all of them are the delivered ones.
  parameters.adopt(delivered_);
  parameters.note_refusal(reason_of(status.error, status.quantity), address_of(Register::kMaximumVelocity));
}

bool ParameterKeeper::disabled() const {
  const DriveState state = parts_.drive->state();
  const bool off = state == DriveState::kSwitchOnDisabled || state == DriveState::kReady || state == DriveState::kFault;
  return off && !parts_.drive->loop().enabled;
}

uint16_t ParameterKeeper::refusal(CommandKey key) const {
  if (busy_) return kReasonNotStanding;
  if (key == CommandKey::kReset && restart_ == nullptr) return kReasonNotAvailable;
  // The image would have neither the shaper of before nor the one that is on its way.
  if (key == CommandKey::kSave && parts_.shaper->waiting()) return kReasonNotStanding;
  return disabled() ? 0 : kReasonNotDisabled;
}

void ParameterKeeper::request(CommandKey key, uint32_t uptime_ms) {
  busy_ = true;
  key_ = key;
  requested_at_ms_ = uptime_ms;
  parts_.parameters->set(Register::kCommandResult, static_cast<uint32_t>(CommandResult::kBusy));
}

void ParameterKeeper::service(uint32_t uptime_ms) {
  if (!busy_ || uptime_ms - requested_at_ms_ < kCommandDelayMs) return;
  busy_ = false;
  const uint16_t reason = execute();
  const CommandResult result = reason == 0 ? CommandResult::kDone : CommandResult::kFailed;
  parts_.parameters->set(Register::kCommandResult, static_cast<uint32_t>(result));
  if (reason != 0) parts_.parameters->note_refusal(reason, address_of(Register::kCommandKey));
}

// 0, or why it was not done.
uint16_t ParameterKeeper::execute() {
  if (!disabled()) return kReasonNotDisabled;
  if (key_ == CommandKey::kSave && parts_.shaper->waiting()) return kReasonNotStanding;
  if (key_ == CommandKey::kSave) return store_.save(*parts_.parameters, *parts_.shaper) ? 0 : kReasonFlashSilent;
  if (key_ == CommandKey::kLoadDefaults) return load_defaults();
  restart_();
  return kReasonNotAvailable;  // or it would not have come back
}

uint16_t ParameterKeeper::load_defaults() {
  const Status status = parts_.axis->configure(delivered_);
  if (!status.ok()) return status.error == Error::kBusy ? kReasonNotStanding : reason_of(status.error, status.quantity);
  for (size_t i = 0; i < kParameterCount; ++i) {
    const Parameter parameter = kParameters[i];
    if (!stored(parameter)) continue;
    for (uint32_t set = 0; set < kShaperSets && of_shaper_set(parameter); ++set) {
      parts_.shaper->stage(set, parameter.name, parameter.initial);
    }
    if (!of_shaper_set(parameter)) parts_.parameters->set_value(i, parameter.initial);
  }
  parts_.shaper->take_off();
  parts_.parameters->adopt(delivered_);
  registers_->watch();
  return 0;
}

}  // namespace stillpoint::firmware
