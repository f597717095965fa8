// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/chip_client.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/state_machine.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Register;

constexpr uint16_t kShutdown = 0x06;
constexpr uint16_t kSwitchOn = 0x07;
constexpr uint16_t kEnableOperation = 0x0F;
constexpr uint16_t kApplyAtRest = 1;

std::string hexadecimal(uint16_t value) { return fmt::format("{:04X}h", value); }

sim::Refusal cannot(const std::string& what, const std::string& value, const std::string& why,
                    const std::string& result) {
  return sim::Refusal(sim::Refusal::Cause::kCannot, what, value, why, result);
}

[[noreturn]] void refuse_fault(uint16_t fault) {
  if (fault == static_cast<uint16_t>(firmware::FaultCode::kLinkSilent)) {
    throw cannot("host", "too slow", "the drive heard nothing for 100 ms, a machine with less to do is accepted",
                 kHostTooSlow);
  }
  throw cannot("drive", "fault " + hexadecimal(fault), "a move without a fault is accepted", "drive_fault");
}

}  // namespace

void ChipClient::enable() {
  for (const uint16_t word : {kShutdown, kSwitchOn, kEnableOperation}) write(Register::kControlword, word);
  wait("operation enabled", [this] { return is_enabled(); });
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
  write(Register::kControlword, static_cast<uint16_t>(kEnableOperation | firmware::kControlNewSetPoint | how));
  wait("the set-point taken", [this] {
    if (read(Register::kRefusalReason) != 0) refuse_with_reason();
    return (status() & firmware::kStatusSetPointTaken) != 0;
  });
  write(Register::kControlword, kEnableOperation);
  MoveReport report{};
  report.profile_ticks = read32(Register::kMoveProfileTicks);
  report.total_ticks = read32(Register::kMoveTotalTicks);
  report.zero_delay_met = read(Register::kMoveZeroDelayMet) != 0;
  return report;
}

void ChipClient::finish(uint64_t ticks) {
  wait(
      "the target reached", [this] { return (status() & firmware::kStatusTargetReached) != 0; },
      kPatienceTicks + ticks);
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
  const uint32_t accepted = read32(Register::kRefusalAccepted);
  const bool by_the_core = (refusal[0] & 0x8000U) == 0;
  const std::string why = by_the_core ? text(static_cast<Error>(refusal[0] >> 8)) : "reason " + hexadecimal(refusal[0]);
  const std::string what = by_the_core ? text(static_cast<Quantity>(refusal[0] & 0xFF)) : "drive";
  throw cannot(what, "register " + hexadecimal(refusal[1]),
               why + (accepted != 0 ? ", the drive would have accepted " + std::to_string(accepted) + " there"
                                    : ", the drive names nothing that it would have accepted"),
               "drive_refused");
}

}  // namespace stillpoint::cli
