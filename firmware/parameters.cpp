// SPDX-License-Identifier: Apache-2.0
#include "firmware/parameters.hpp"

namespace stillpoint::firmware {
namespace {

// Both orders in one: a signed value with its sign bit turned round sorts as an unsigned one.
uint32_t sort_key(const Parameter& parameter, uint32_t value) {
  return parameter.is_signed() ? value ^ (UINT32_C(1) << 31) : value;
}

uint32_t whole_register(double value) {
  if (!(value >= 1.0)) return 1;
  if (value >= static_cast<double>(UINT32_MAX)) return UINT32_MAX;
  return static_cast<uint32_t>(value);
}

}  // namespace

bool in_range(const Parameter& parameter, uint32_t ceiling, uint32_t value, uint32_t& accepted) {
  const uint32_t key = sort_key(parameter, value);
  accepted = value;
  if (key < sort_key(parameter, parameter.minimum)) {
    accepted = parameter.minimum;
    return false;
  }
  if (key > sort_key(parameter, ceiling)) {
    accepted = ceiling;
    return false;
  }
  if (parameter.unused_or_more()) {
    if (value != 0 && value < parameter.allowed) accepted = parameter.allowed;
    return accepted == value;
  }
  const uint32_t above = value - parameter.minimum;
  return parameter.allowed == 0 || (above < 32 && ((parameter.allowed >> above) & 1U) != 0);
}

void Parameters::load_defaults() {
  for (size_t i = 0; i < kParameterCount; ++i) values_[i] = kParameters[i].initial;
}

uint32_t Parameters::get(Register name) const { return values_[find_parameter(address_of(name))]; }

void Parameters::set(Register name, uint32_t value) { values_[find_parameter(address_of(name))] = value; }

void Parameters::adopt_one(Register name, double value) { set(name, whole_register(value)); }

Register Parameters::lower_to_ceilings() {
  Register lowered = kNoRegister;
  for (size_t i = 0; i < kParameterCount; ++i) {
    const Parameter parameter = kParameters[i];
    if (parameter.ceiling == kNoRegister) continue;
    const uint32_t ceiling = get(parameter.ceiling);
    if (values_[i] <= ceiling) continue;
    values_[i] = ceiling;
    lowered = parameter.name;
  }
  return lowered;
}

void Parameters::adopt(const AxisConfig& config) {
  adopt_one(Register::kMaximumVelocity, config.maximum.velocity);
  const bool even = config.maximum.acceleration <= config.maximum.deceleration;
  adopt_one(Register::kMaximumAcceleration, even ? config.maximum.acceleration : config.maximum.deceleration);
  adopt_one(Register::kMaximumJerk, config.maximum.jerk / kJerkUnit);
  lower_to_ceilings();
  adopt_one(Register::kQuickStopDeceleration, config.quick_stop_deceleration);
  adopt_one(Register::kQuickStopJerk, config.quick_stop_jerk / kJerkUnit);
  set_signed(Register::kSoftLimitLow, config.soft_low_counts);
  set_signed(Register::kSoftLimitHigh, config.soft_high_counts);
}

void Parameters::note_refusal(uint16_t reason, uint16_t culprit, uint32_t accepted) {
  set(Register::kRefusalReason, reason);
  set(Register::kRefusedRegister, culprit);
  set(Register::kRefusalAccepted, accepted);
}

[[gnu::noinline]] void Parameters::note_out_of_range(Register culprit, uint32_t value, uint32_t accepted) {
  const bool available = accepted != value;
  note_refusal(available ? kReasonOutOfRange : kReasonNotAvailable, address_of(culprit), available ? accepted : 0);
}

}  // namespace stillpoint::firmware
