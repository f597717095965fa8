// SPDX-License-Identifier: Apache-2.0
#include "firmware/register_bank.hpp"

#include "firmware/axis_limits.hpp"
#include "firmware/parameter_keeper.hpp"

namespace stillpoint::firmware {
namespace {

constexpr uint16_t kApplyAtRest = 1;
constexpr uint16_t kApplyBlended = 2;
constexpr uint16_t kApplyDiscard = 3;
constexpr uint32_t kAddressSpace = 0x10000;

bool known_key(uint32_t key) {
  switch (static_cast<CommandKey>(key)) {
    case CommandKey::kUnlock:
    case CommandKey::kSave:
    case CommandKey::kLoadDefaults:
    case CommandKey::kReset: return true;
  }
  return false;
}

Register limit_register(Quantity quantity) {
  switch (quantity) {
    case Quantity::kVelocity: return Register::kMaximumVelocity;
    case Quantity::kAcceleration: return Register::kMaximumAcceleration;
    case Quantity::kDeceleration: return Register::kQuickStopDeceleration;
    case Quantity::kPosition: return Register::kSoftLimitLow;
    default: return Register::kMaximumJerk;
  }
}

}  // namespace

// A write that is being checked.
struct RegisterBank::Request {
  uint32_t first;
  uint32_t count;
  const uint16_t* words;

  uint32_t end() const { return first + count; }

  bool holds(const Parameter& parameter) const {
    const uint32_t address = address_of(parameter.name);
    return address >= first && address + parameter.words() <= end();
  }

  // As the type's bits. `parameter` is one that it holds.
  uint32_t value_of(const Parameter& parameter) const {
    const uint16_t* at = words + (address_of(parameter.name) - first);
    if (parameter.words() == 2) return (uint32_t{at[0]} << 16) | at[1];
    return parameter.is_signed() ? static_cast<uint32_t>(static_cast<int32_t>(static_cast<int16_t>(at[0]))) : at[0];
  }

  // Calls visit(parameter, index) for each whole parameter until one returns false.
  template <typename Visit>
  bool each(Visit visit) const {
    size_t index = 0;
    for (uint32_t address = first; address < end();) {
      const Parameter parameter = take(address, index);
      if (!visit(parameter, index)) return false;
    }
    return true;
  }

  // The parameter at `address`, which goes on to the next.
  [[gnu::noinline]] static Parameter take(uint32_t& address, size_t& index) {
    index = find_parameter(static_cast<uint16_t>(address));
    const Parameter parameter = kParameters[index];
    address += parameter.words();
    return parameter;
  }
};

void RegisterBank::begin(const Parts& parts) {
  parts_ = parts;
  const double tick_s = parts.axis->config().tick_s;
  ticks_per_second_ = tick_s > 0.0 ? static_cast<uint32_t>(1.0 / tick_s + 0.5) : 0;
  watch();
}

// Everything that the loop watches, as the registers have it.
void RegisterBank::watch() {
  const Parameters& parameters = *parts_.parameters;
  ControlLoop& loop = *parts_.loop;
  const uint32_t window = parameters.get(Register::kPositionWindow);
  FeedbackLimits limits = {};
  limits.following_window = parameters.get(Register::kFollowingErrorWindow);
  limits.ticks = ticks_of(parameters.get(Register::kFollowingErrorTimeMs));
  limits.most_per_tick = most_per_tick(parameters.get(Register::kMaximumVelocity));
  limits.low = parameters.get_signed(Register::kSoftLimitLow);
  limits.high = parameters.get_signed(Register::kSoftLimitHigh);
  limits.margin = window < kMostLimitMargin ? window : kMostLimitMargin;
  loop.watch(limits);
  loop.set_position_window(window);
  loop.set_client_watchdog(parameters.get(Register::kClientWatchdogMs));
  loop.set_fault_option(static_cast<StopOption>(parameters.get(Register::kFaultOption)));
}

uint32_t RegisterBank::ticks_of(uint32_t ms) const {
  return static_cast<uint32_t>(uint64_t{ms} * ticks_per_second_ / 1000U);
}

// Twice the axis's fastest, and what a coarse encoder may jump by.
uint32_t RegisterBank::most_per_tick(uint32_t velocity) const {
  constexpr uint32_t kJitterCounts = 1000;
  const uint64_t counts = ticks_per_second_ == 0 ? 0 : uint64_t{velocity} * 2 / ticks_per_second_ + kJitterCounts;
  return counts < UINT32_MAX ? static_cast<uint32_t>(counts) : UINT32_MAX;
}

Status RegisterBank::take_parameters() {
  const Status status = configure_axis({0, 0, nullptr});
  if (status.ok()) watch();
  return status;
}

void RegisterBank::set_uptime(uint32_t uptime_ms) {
  uptime_ms_ = uptime_ms;
  if (uptime_ms_ - unlocked_at_ms_ >= kUnlockedMs) unlocked_ = false;
}

ModbusException RegisterBank::write(uint16_t first, uint32_t count, const uint16_t* words) {
  const Request request = {first, count, words};
  if (first == kFirstStreamPosition) return write_stream(request);
  ModbusException refused = check_addresses(request);
  if (refused == ModbusException::kNone) refused = check_values(request);
  if (refused == ModbusException::kNone) refused = check_state(request);
  if (refused == ModbusException::kNone) commit(request);
  return refused;
}

ModbusException RegisterBank::write_stream(const Request& request) {
  if (request.count > 2 * kStreamWindow) return ModbusException::kIllegalAddress;
  if (request.count % 2 != 0) return ModbusException::kIllegalValue;
  int32_t positions[kStreamWindow];
  for (uint32_t i = 0; i < request.count / 2; ++i) {
    positions[i] = static_cast<int32_t>((uint32_t{request.words[2 * i]} << 16) | request.words[2 * i + 1]);
  }
  const size_t room = kStreamPositions - parts_.stream->buffered();
  if (parts_.stream->accept(positions, request.count / 2)) return ModbusException::kNone;
  const bool full = request.count / 2 > room;
  parts_.parameters->note_refusal(full ? kReasonStreamFull : kReasonOutOfRange, kFirstStreamPosition,
                                  static_cast<uint32_t>(full ? static_cast<int64_t>(room) : kMostStreamStep));
  return full ? ModbusException::kDeviceBusy : ModbusException::kIllegalValue;
}

ModbusException RegisterBank::write_from_all(uint16_t first, uint32_t count, const uint16_t* words) {
  const bool enabled = parts_.drive->state() == DriveState::kOperationEnabled;
  bool safe = !enabled;
  if (first == address_of(Register::kControlword)) {
    const bool halts = enabled && (words[0] & kControlHalt) != 0;
    safe = (words[0] & kControlNewSetPoint) == 0 && (halts || command_of(words[0]) != DriveCommand::kEnableOperation);
  }
  if (safe) return write(first, count, words);
  parts_.parameters->note_refusal(kReasonBroadcast, first);
  return ModbusException::kDeviceBusy;
}

ModbusException RegisterBank::check_addresses(const Request& request) const {
  if (request.end() > kAddressSpace) return ModbusException::kIllegalAddress;
  for (uint32_t address = request.first; address < request.end(); ++address) {
    const size_t index = find_parameter(static_cast<uint16_t>(address));
    if (index == kNoParameter || !kParameters[index].writable()) return ModbusException::kIllegalAddress;
  }
  return ModbusException::kNone;
}

ModbusException RegisterBank::check_values(const Request& request) {
  const bool good = request.each([&](const Parameter& parameter, size_t) {
    if (!request.holds(parameter)) return false;  // half of a 32-bit value
    const uint32_t ceiling = parameter.ceiling == kNoRegister ? parameter.maximum : staged(request, parameter.ceiling);
    const uint32_t value = request.value_of(parameter);
    if (parameter.effect == Effect::kCommandKey) return known_key(value);
    uint32_t accepted = 0;
    if (in_range(parameter, ceiling, value, accepted)) return true;
    parts_.parameters->note_out_of_range(parameter.name, value, accepted);
    return false;
  });
  return good ? ModbusException::kNone : ModbusException::kIllegalValue;
}

ModbusException RegisterBank::check_state(const Request& request) {
  uint16_t reason = 0;
  Register culprit = kNoRegister;
  bool limits = false;
  bool commands = false;
  const bool good = request.each([&](const Parameter& parameter, size_t) {
    culprit = parameter.name;
    if (parameter.lock == Lock::kNeedsKey && !unlocked_) reason = kReasonLocked;
    if (parameter.effect == Effect::kCommandKey) reason = key_refusal(request.value_of(parameter));
    const bool tracks = parameter.name == Register::kTracking && request.value_of(parameter) != 0;
    if ((parameter.effect == Effect::kTune || tracks) && !parts_.tuner->available()) reason = kReasonNotAvailable;
    limits = limits || parameter.effect == Effect::kAxisLimits;
    commands = commands || parameter.effect == Effect::kTune || parameter.effect == Effect::kScope;
    const bool applies = parameter.effect == Effect::kApplyShaper && request.value_of(parameter) != kApplyDiscard;
    const bool needs_axis = limits || applies || parameter.effect == Effect::kVelocity;
    if (reason == 0 && needs_axis && parts_.tuner->busy()) reason = kReasonTuning;
    return reason == 0;
  });
  if (!good) {
    if (culprit == Register::kCommandKey && reason != kReasonLocked && !parts_.keeper->busy())
      parts_.parameters->set(Register::kCommandResult, static_cast<uint32_t>(CommandResult::kFailed));
    return refuse_state(reason, culprit);
  }
  if (commands) return keeps_record_ ? refuse_state(kReasonNothingToDo, culprit) : do_commands(request);
  return limits ? check_limits(request, culprit) : ModbusException::kNone;
}

ModbusException RegisterBank::check_limits(const Request& request, Register culprit) {
  const Status status = configure_axis(request);
  if (status.ok()) return ModbusException::kNone;
  if (status.error == Error::kBusy) return refuse_state(kReasonNotStanding, culprit);
  return refuse_state(reason_of(status.error, status.quantity), limit_register(status.quantity));
}

ModbusException RegisterBank::refuse_state(uint16_t reason, Register culprit) {
  parts_.parameters->note_refusal(reason, address_of(culprit));
  return ModbusException::kDeviceBusy;
}

ModbusException RegisterBank::check_disabled() {
  return parts_.keeper->disabled() ? ModbusException::kNone : refuse_state(kReasonNotDisabled, kNoRegister);
}

uint16_t RegisterBank::key_refusal(uint32_t key) const {
  if (key == static_cast<uint32_t>(CommandKey::kUnlock)) return 0;
  return unlocked_ ? parts_.keeper->refusal(static_cast<CommandKey>(key)) : kReasonLocked;
}

uint32_t RegisterBank::staged(const Request& request, Register name) const {
  const Parameter parameter = kParameters[find_parameter(address_of(name))];
  return request.holds(parameter) ? request.value_of(parameter) : parts_.parameters->get(name);
}

// As it will be once the request is done.
uint32_t RegisterBank::staged_under_ceiling(const Request& request, Register name) const {
  const uint32_t value = staged(request, name);
  const Register ceiling = kParameters[find_parameter(address_of(name))].ceiling;
  const uint32_t most = ceiling == kNoRegister ? value : staged(request, ceiling);
  return value < most ? value : most;
}

// Those that look at what comes with them too. No request reaches from one to the other.
ModbusException RegisterBank::do_commands(const Request& request) {
  Parameters staged = *parts_.parameters;
  Effect effect = {};
  uint32_t command = 0;
  request.each([&](const Parameter& parameter, size_t index) {
    const uint32_t value = request.value_of(parameter);
    if (parameter.effect == Effect::kTune || parameter.effect == Effect::kScope) {
      effect = parameter.effect;
      command = value;
    }
    staged.set_value(index, value);
    return true;
  });
  const bool done = effect == Effect::kTune
                        ? parts_.tuner->command(static_cast<TuneCommand>(command), staged, uptime_ms_)
                        : parts_.scope->command(static_cast<ScopeCommand>(command), staged);
  return done ? ModbusException::kNone : ModbusException::kDeviceBusy;
}

// Refused while the axis moves, and then nothing has changed.
Status RegisterBank::configure_axis(const Request& request) {
  AxisConfig config = parts_.axis->config();
  take_axis_limits([&](Register name) { return staged_under_ceiling(request, name); }, config);
  return parts_.axis->configure(config);
}

void RegisterBank::commit(const Request& request) {
  // The set first, so that modes written with it go to the set that they name.
  request.each([&](const Parameter& parameter, size_t) {
    if (parameter.effect == Effect::kShaperSet) parts_.shaper->show_set(request.value_of(parameter));
    return true;
  });
  bool limits = false;  // which the axis has taken in the check
  request.each([&](const Parameter& parameter, size_t index) {
    const uint32_t value = request.value_of(parameter);
    if (parameter.readable()) parts_.parameters->set_value(index, value);
    set_off(parameter, value);
    limits = limits || parameter.effect == Effect::kAxisLimits;
    return true;
  });
  if (!limits) return;
  parts_.parameters->lower_to_ceilings();
  watch();
}

void RegisterBank::set_off(const Parameter& parameter, uint32_t value) {
  switch (parameter.effect) {
    case Effect::kControlword: parts_.drive->write_controlword(static_cast<uint16_t>(value)); break;
    case Effect::kWatch: watch(); break;
    case Effect::kVelocity: parts_.drive->write_velocity(); break;
    case Effect::kApplyShaper:
      if (value == kApplyAtRest || value == kApplyBlended) {
        parts_.shaper->request_apply(value == kApplyBlended ? Retune::kBlended : Retune::kAtRest);
      } else {
        parts_.shaper->discard();
      }
      break;
    case Effect::kCommandKey:
      if (value != static_cast<uint32_t>(CommandKey::kUnlock)) {
        parts_.keeper->request(static_cast<CommandKey>(value), uptime_ms_);
        break;
      }
      unlocked_ = true;
      unlocked_at_ms_ = uptime_ms_;
      if (!parts_.keeper->busy())
        parts_.parameters->set(Register::kCommandResult, static_cast<uint32_t>(CommandResult::kDone));
      break;
    case Effect::kAxisLimits:  // done after the others
    case Effect::kTune:        // done as the last of the checks
    case Effect::kScope:
    case Effect::kShaperSet:  // done before the others
    case Effect::kNone: break;
  }
}

}  // namespace stillpoint::firmware
