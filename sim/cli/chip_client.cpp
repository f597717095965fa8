// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/chip_client.hpp"

#include <algorithm>

#include "firmware/parameters.hpp"
#include "firmware/state_machine.hpp"
#include "sim/cli/drive_state.hpp"
#include "sim/cli/drive_texts.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::DriveState;
using firmware::Register;

constexpr uint16_t kApplyAtRest = 1;

// A second for what takes a tick or two.
constexpr uint64_t kFeedbackPatienceTicks = 1000;
constexpr uint64_t kModePatienceTicks = 1000;

sim::Refusal cannot(const std::string& what, const std::string& value, const std::string& why,
                    const std::string& result) {
  return sim::Refusal(sim::Refusal::Cause::kCannot, what, value, why, result);
}

// What it takes depends on registers beside it, which the drive then names.
bool looks_at_others(const firmware::Parameter& parameter) {
  return parameter.effect == firmware::Effect::kAxisLimits || parameter.effect == firmware::Effect::kTune ||
         parameter.effect == firmware::Effect::kScope;
}

[[noreturn]] void refuse_fault(uint16_t fault) {
  if (fault == static_cast<uint16_t>(firmware::FaultCode::kLinkSilent)) {
    throw cannot("host", "too slow", "the drive heard nothing for 100 ms, a machine with less to do is accepted",
                 kHostTooSlow);
  }
  throw cannot("drive", "fault " + hexadecimal(fault),
               std::string(text_of_fault(fault)) + ", a reset of the fault is accepted first", "drive_fault");
}

}  // namespace

DriveState ChipClient::state() { return state_of(status()); }

void ChipClient::enable() {
  bool asked = false;
  const uint64_t begun = port_.ticks();
  try {
    wait("operation enabled", [&] {
      if (step_towards_enabled(asked)) return true;
      const bool unheard = (read(Register::kWarnings) & firmware::kWarningFeedbackMissing) != 0;
      if (unheard && port_.ticks() - begun > kFeedbackPatienceTicks)
        throw cannot("drive", "no feedback", "the servo link gives no valid position, one that does is accepted",
                     "no_feedback");
      return false;
    });
  } catch (const sim::Refusal&) {
    if (asked) try_to_write_controlword(kDisableVoltage);  // or it would come on once it can
    throw;
  }
}

// One word at most; true once it is there, where nothing is written.
bool ChipClient::step_towards_enabled(bool& asked) {
  uint16_t word = kEnableOperation;
  switch (state()) {
    case DriveState::kOperationEnabled:
      // Any other command is a ramp before disabling, after which it is enabled anew.
      return firmware::command_of(read(Register::kControlword)) == firmware::DriveCommand::kEnableOperation;
    case DriveState::kSwitchOnDisabled: word = kShutdown; break;
    case DriveState::kReady: word = kSwitchOn; break;
    case DriveState::kSwitchedOn:
    case DriveState::kQuickStopActive: break;  // goes on where it stays, and else ends by itself
    default: return false;
  }
  asked = true;
  write(Register::kControlword, word);
  return false;
}

void ChipClient::take_profile_position_mode() {
  constexpr auto kPositions = static_cast<uint16_t>(firmware::OperationMode::kProfilePosition);
  const uint16_t before = read(Register::kMode);
  uint16_t shown = read(Register::kModeDisplay);
  if (before == kPositions && shown == kPositions) return;
  write(Register::kMode, kPositions);
  for (const uint64_t begun = port_.ticks(); shown != kPositions && port_.ticks() - begun < kModePatienceTicks;)
    shown = read(Register::kModeDisplay);
  if (shown == kPositions) return;
  write(Register::kMode, before);
  throw cannot("mode", std::to_string(shown), "in force while the axis moves or is tuned, a move is accepted at rest",
               "mode_in_force");
}

void ChipClient::set_shaper(const std::vector<ModeRegisters>& modes) {
  write(Register::kModeCount, static_cast<uint16_t>(modes.size()));
  for (uint32_t k = 0; k < modes.size(); ++k) {
    const ModeRegisters& mode = modes[k];
    port_.write(address_of(firmware::mode_register(k, firmware::ModeField::kFrequency)),
                {static_cast<uint16_t>(mode.frequency >> 16), static_cast<uint16_t>(mode.frequency), mode.damping,
                 mode.tolerance, mode.kind, mode.spacing});
  }
  write(Register::kApplyShaper, kApplyAtRest);
  wait("the shaper in force", [this] {
    const auto state = static_cast<firmware::ShaperState>(read(Register::kShaperState));
    if (state == firmware::ShaperState::kRefused) refuse_with_reason();
    return state != firmware::ShaperState::kPending;
  });
}

std::vector<ModeRegisters> ChipClient::staged_modes() {
  std::vector<ModeRegisters> modes(read(Register::kModeCount));
  for (uint32_t k = 0; k < modes.size(); ++k) {
    const auto field = [&](firmware::ModeField name) { return read(firmware::mode_register(k, name)); };
    ModeRegisters& mode = modes[k];
    mode.frequency = read32(firmware::mode_register(k, firmware::ModeField::kFrequency));
    mode.damping = field(firmware::ModeField::kDamping);
    mode.tolerance = field(firmware::ModeField::kTolerance);
    mode.kind = field(firmware::ModeField::kKind);
    mode.spacing = field(firmware::ModeField::kSpacing);
  }
  return modes;
}

void ChipClient::set_move(const MoveRegisters& move) {
  raise_maximum(Register::kMaximumVelocity, move.velocity);
  raise_maximum(Register::kMaximumAcceleration, std::max(move.acceleration, move.deceleration));
  raise_maximum(Register::kMaximumJerk, move.jerk);
  write32(Register::kTargetPosition, static_cast<uint32_t>(move.target));
  write32(Register::kProfileVelocity, move.velocity);
  write32(Register::kProfileAcceleration, move.acceleration);
  write32(Register::kProfileDeceleration, move.deceleration);
  write32(Register::kProfileJerk, move.jerk);
  write(Register::kProfileType, static_cast<uint16_t>(move.kind));
  write32(Register::kMoveDurationMs, move.duration_ms);
  write(Register::kZeroDelay, move.zero_delay);
}

MoveReport ChipClient::start(bool relative) {
  const uint16_t how = relative ? firmware::kControlRelative : uint16_t{0};
  take_set_point_back();  // one that was refused may still stand: the bit is to rise
  wait_for_room();
  write(Register::kControlword, static_cast<uint16_t>(kEnableOperation | firmware::kControlNewSetPoint | how));
  try {
    wait("the set-point taken", [this] {
      const uint16_t statusword = status();
      refuse_unless_enabled(statusword);
      if (read(Register::kRefusalReason) != 0) refuse_with_reason();
      return (statusword & firmware::kStatusSetPointTaken) != 0;
    });
  } catch (const sim::Refusal&) {
    try_to_take_set_point_back();
    throw;
  }
  write(Register::kControlword, kEnableOperation);
  // One that was kept is planned only now.
  if (wait_for_room() && read(Register::kRefusalReason) != 0) refuse_with_reason();
  MoveReport report{};
  report.profile_ticks = read32(Register::kMoveProfileTicks);
  report.total_ticks = read32(Register::kMoveTotalTicks);
  report.zero_delay_met = read(Register::kMoveZeroDelayMet) != 0;
  return report;
}

void ChipClient::finish(uint64_t ticks) {
  wait(
      "the target reached",
      [this] {
        const uint16_t statusword = status();
        refuse_unless_enabled(statusword);
        return (statusword & firmware::kStatusTargetReached) != 0;
      },
      kPatienceTicks + ticks);
  if ((read(Register::kControlword) & firmware::kControlHalt) != 0)
    throw cannot("drive", "halted", "the move was given up on its way, another one is accepted", "halted");
}

// A set-point kept behind a move shows in bit 12 until it is under way, and only then tells its ticks.
bool ChipClient::wait_for_room() {
  const auto taken = [this] { return (status() & firmware::kStatusSetPointTaken) != 0; };
  if (!taken()) return false;
  wait(
      "the move before it done", [&] { return !taken(); }, kPatienceTicks + read32(Register::kMoveTotalTicks));
  return true;
}

void ChipClient::take_set_point_back() {
  refuse_unless_enabled(status());
  write(Register::kControlword, kEnableOperation);
}

void ChipClient::try_to_take_set_point_back() {
  try {
    take_set_point_back();
  } catch (const sim::Refusal&) {  // silent, or no longer enabled: it has dropped it
  }
}

void ChipClient::try_to_write_controlword(uint16_t word) {
  try {
    write(Register::kControlword, word);
  } catch (const sim::Refusal&) {  // silent: nothing that can be done from here
  }
}

void ChipClient::refuse_unless_enabled(uint16_t statusword) {
  const DriveState state = state_of(statusword);
  if (state == DriveState::kOperationEnabled) return;
  refuse_any_fault();
  throw cannot("drive", text(state), "no longer enabled, a move is accepted in operation enabled", "not_enabled");
}

// The axis's own limits are the delivered ones; a simulated arm stands more.
void ChipClient::raise_maximum(Register name, uint32_t wanted) {
  if (read32(name) >= wanted) return;
  write(Register::kCommandKey, static_cast<uint16_t>(firmware::CommandKey::kUnlock));
  write32(name, wanted);
}

void ChipClient::wait(const char* what, const std::function<bool()>& condition, uint64_t patience_ticks) {
  const uint64_t begun = port_.ticks();
  while (!condition()) {
    refuse_any_fault();
    if (port_.ticks() - begun > patience_ticks) {
      throw cannot("drive", what, "not reached in time, a firmware that gets there is accepted", "drive_stalled");
    }
  }
}

void ChipClient::refuse_any_fault() {
  const uint16_t fault = read(Register::kErrorCode);
  if (fault != 0) refuse_fault(fault);
}

void ChipClient::refuse_with_reason() {
  const std::vector<uint16_t> refusal = port_.read(address_of(Register::kRefusalReason), 2);
  const uint16_t reason = refusal[0];
  const uint32_t accepted = read32(Register::kRefusalAccepted);
  const size_t culprit = firmware::find_parameter(refusal[1]);
  const bool is_signed = culprit != firmware::kNoParameter && firmware::kParameters[culprit].is_signed();
  const std::string value = is_signed ? std::to_string(static_cast<int32_t>(accepted)) : std::to_string(accepted);
  const bool by_the_core = (reason & 0x8000U) == 0;
  const std::string what = by_the_core ? text(static_cast<Quantity>(reason & 0xFF)) : "drive";
  std::string why = by_the_core ? text(static_cast<Error>(reason >> 8)) : text_of_reason(reason);
  if (names_a_value(reason) || accepted != 0) {
    why += ", " + value + " is accepted there";
  } else if (by_the_core) {
    why += ", the drive names nothing that it would have accepted";
  }
  throw cannot(what, "register " + hexadecimal(refusal[1]), why, "drive_refused");
}

// The registers of the last refusal are not written by every exception. 06 always does; 03 for a value that is out of
// range or not available, but not for a key that is not known or half of a wide value; the others never.
void ChipClient::explain(const sim::RegisterRefusal& refusal) {
  constexpr int kIllegalValue = 3;
  constexpr int kBusy = 6;
  const size_t asked = firmware::find_parameter(refusal.address());
  if (asked == firmware::kNoParameter) throw refusal;
  const std::vector<uint16_t> last = port_.read(address_of(Register::kRefusalReason), 2);
  const size_t culprit = firmware::find_parameter(last[1]);
  const bool of_a_value = last[0] == firmware::kReasonOutOfRange || last[0] == firmware::kReasonNotAvailable;
  const bool is_key = refusal.address() == address_of(Register::kCommandKey);
  if (refusal.exception() == kIllegalValue && culprit == asked && of_a_value && !is_key) refuse_with_reason();
  if (refusal.exception() == kBusy && (culprit == asked || looks_at_others(firmware::kParameters[asked])))
    refuse_with_reason();
  throw refusal;
}

}  // namespace stillpoint::cli
