// SPDX-License-Identifier: Apache-2.0
// The firmware's set-up and its handshakes, from a Modbus client's side.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "firmware/registers.hpp"
#include "firmware/state_machine.hpp"
#include "shaper/axis/axis_config.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/hil/register_port.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {

// A Refusal's result where the drive gave up on a host that was kept from running.
constexpr char kHostTooSlow[] = "host_too_slow";

// Everything waits until the firmware has answered, and throws a Refusal: of the line, or with the drive's own reason.
class ChipClient {
 public:
  explicit ChipClient(sim::RegisterPort& port) : port_(port) {}

  firmware::DriveState state();
  bool is_enabled() { return state() == firmware::DriveState::kOperationEnabled; }
  // From whatever state, as CiA 402 has it; a drive that is enabled, halted too, is left as it is. Refuses a fault.
  // Where it cannot be done the drive is off.
  void enable();
  // Puts profile position mode in force. Refuses, the mode of before asked for again, while the axis moves in another.
  void take_profile_position_mode();
  void set_shaper(const std::vector<ModeRegisters>& modes);
  // As the registers 0100 have them.
  std::vector<ModeRegisters> staged_modes();
  void set_move(const MoveRegisters& move);
  // Starts the move that is set, once a move before it is done, in profile position mode; `relative`: its target counts
  // from the one in force.
  MoveReport start(bool relative = false);
  // Until the drive reports the target reached, `ticks` of which the move itself may take. Refuses where it was halted
  // or disabled on its way.
  void finish(uint64_t ticks = 0);

  uint16_t read(firmware::Register name) { return port_.read(firmware::address_of(name), 1)[0]; }
  uint32_t read32(firmware::Register name) { return port_.read32(firmware::address_of(name)); }
  void write(firmware::Register name, uint16_t value) { port_.write(firmware::address_of(name), value); }
  void write32(firmware::Register name, uint32_t value) { port_.write32(firmware::address_of(name), value); }

  // Asks until it is so; refuses a fault meanwhile, and `drive_stalled` after `patience_ticks`.
  // A stalled drive ends the run, a slow one does not: planning takes a few ticks of the emulated chip.
  static constexpr uint64_t kPatienceTicks = 20000;
  void wait(const char* what, const std::function<bool()>& condition, uint64_t patience_ticks = kPatienceTicks);

  // Throws a Refusal where the drive is in a fault.
  void refuse_any_fault();

  // With what registers 0012, 0013 and 0016 say.
  [[noreturn]] void refuse_with_reason();
  // The same where they are about this refusal, and not about one before it; else throws that itself.
  [[noreturn]] void explain(const sim::RegisterRefusal& refusal);

 private:
  bool step_towards_enabled(bool& asked);
  bool wait_for_room();  // whether there was none
  void take_set_point_back();
  void try_to_take_set_point_back();
  void try_to_write_controlword(uint16_t word);
  void refuse_unless_enabled(uint16_t statusword);
  uint16_t status() { return read(firmware::Register::kStatusword); }
  void raise_maximum(firmware::Register name, uint32_t wanted);

  sim::RegisterPort& port_;
};

// `run` on a fresh chip, again when this process was kept from running for so long that the drive gave up on it.
template <typename Run>
auto on_a_fast_enough_host(const Run& run) {
  constexpr int kAttempts = 5;
  for (int attempt = 1;; ++attempt) {
    try {
      return run();
    } catch (const sim::Refusal& refusal) {
      if (refusal.result() != kHostTooSlow || attempt == kAttempts) throw;
    }
  }
}

}  // namespace stillpoint::cli
