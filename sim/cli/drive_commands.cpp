// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_commands.hpp"

#include "sim/cli/chip_client.hpp"
#include "sim/cli/drive_registers.hpp"
#include "sim/cli/drive_state.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::DriveState;
using firmware::Register;

[[noreturn]] void refuse_state(DriveState state, const char* why, const char* result) {
  throw sim::Refusal(sim::Refusal::Cause::kCannot, "drive", text(state), why, result);
}

bool is_fault(DriveState state) { return state == DriveState::kFaultReaction || state == DriveState::kFault; }

// Through a fault's ramp too.
void wait_while(ChipClient& client, sim::RegisterPort& port, DriveState state) {
  for (const uint64_t begun = port.ticks(); client.state() == state;) {
    if (port.ticks() - begun > ChipClient::kPatienceTicks)
      refuse_state(state, "not over in time, a drive that gets on is accepted", "drive_stalled");
  }
}

}  // namespace

void enable_drive(sim::RegisterPort& port) { ChipClient(port).enable(); }

void disable_drive(sim::RegisterPort& port) { ChipClient(port).write(Register::kControlword, kDisableVoltage); }

void halt_drive(sim::RegisterPort& port) {
  ChipClient client(port);
  const DriveState state = client.state();
  if (is_fault(state)) client.refuse_any_fault();
  if (state == DriveState::kQuickStopActive)
    refuse_state(state, "it stops already, a halt is accepted in operation enabled", "quick_stop");
  if (state != DriveState::kOperationEnabled)
    refuse_state(state, "nothing to halt, a halt is accepted in operation enabled", "not_enabled");
  // The other bits as they are: a ramp before disabling goes on.
  const uint16_t controlword = client.read(Register::kControlword);
  client.write(Register::kControlword, static_cast<uint16_t>(controlword | firmware::kControlHalt));
}

void stop_drive(sim::RegisterPort& port) { ChipClient(port).write(Register::kControlword, kQuickStop); }

void reset_drive(sim::RegisterPort& port) {
  ChipClient client(port);
  const DriveState state = client.state();
  if (!is_fault(state)) refuse_state(state, "no fault to reset, a drive in a fault is accepted", "no_fault");
  wait_while(client, port, DriveState::kFaultReaction);
  for (const uint16_t word : {kDisableVoltage, firmware::kControlFaultReset, kDisableVoltage})
    client.write(Register::kControlword, word);
  wait_while(client, port, DriveState::kFault);
}

void save_settings(sim::RegisterPort& port) {
  using firmware::CommandResult;
  ChipClient client(port);
  unlock(port);
  write_parameter(port, firmware::kParameters[firmware::find_parameter(address_of(Register::kCommandKey))],
                  static_cast<int64_t>(firmware::CommandKey::kSave));
  auto result = CommandResult::kBusy;
  for (const uint64_t begun = port.ticks(); result == CommandResult::kBusy;) {
    if (port.ticks() - begun > ChipClient::kPatienceTicks)
      throw sim::Refusal(sim::Refusal::Cause::kCannot, "save", "not done in time", "a memory that gets on is accepted",
                         "drive_stalled");
    result = static_cast<CommandResult>(client.read(Register::kCommandResult));
  }
  if (result == CommandResult::kFailed) client.refuse_with_reason();
}

void refuse_unless_ready_to_move(sim::RegisterPort& port) {
  ChipClient client(port);
  client.refuse_any_fault();
  if (client.state() != DriveState::kQuickStopActive) return;
  refuse_state(DriveState::kQuickStopActive, "a motion does not end it, one is accepted after `enable`", "quick_stop");
}

MoveReport start_move(sim::RegisterPort& port, const MoveRequest& request) {
  refuse_unless_ready_to_move(port);
  ChipClient client(port);
  client.take_profile_position_mode();
  client.enable();
  client.write32(Register::kTargetPosition, static_cast<uint32_t>(request.counts));
  return client.start(request.relative);
}

}  // namespace stillpoint::cli
