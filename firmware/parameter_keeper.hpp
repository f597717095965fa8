// SPDX-License-Identifier: Apache-2.0
// What is done with the parameters as a whole: taken from the stored image at the start; saved, put back to what was
// delivered, and the chip restarted by the command keys of register 0014.
#pragma once

#include <stdint.h>

#include "firmware/parameter_store.hpp"
#include "firmware/register_bank.hpp"
#include "firmware/registers.hpp"
#include "hal/nonvolatile.hpp"

namespace stillpoint::firmware {

// Background. Zero-initialised storage is valid.
//
// A command is accepted only while the drive is disabled (switch-on disabled, ready, fault) and none is under way: an
// erase stops the chip's code, a restart its control. It is begun kCommandDelayMs later, so that the client's answer is
// out by then, and refused after all if the drive has left that state; 0015 is busy meanwhile, then done or failed,
// with the reason in 0012.
class ParameterKeeper {
 public:
  static constexpr uint32_t kCommandDelayMs = 20;

  using Restart = void (*)();

  // Takes the axis's configuration for the delivered one, then loads. Without `memory` nothing is stored, and a save
  // fails; without `restart` a reset is not available. What was not loaded as it was saved is named in 0012.
  void begin(const RegisterBank::Parts& parts, RegisterBank& registers, hal::Nonvolatile* memory, Restart restart);

  // Why this cannot be asked for now, or 0.
  uint16_t refusal(CommandKey key) const;
  void request(CommandKey key, uint32_t uptime_ms);
  bool busy() const { return busy_; }
  // In switch-on disabled, ready or fault, and the output stage off.
  bool disabled() const;

  // As often as possible, when there is time: an erase may take seconds.
  void service(uint32_t uptime_ms);

 private:
  void load();
  uint16_t execute();
  uint16_t load_defaults();

  RegisterBank::Parts parts_ = {};
  RegisterBank* registers_ = nullptr;
  Restart restart_ = nullptr;
  ParameterStore store_ = {};
  AxisConfig delivered_ = {};
  bool busy_ = false;
  CommandKey key_ = {};
  uint32_t requested_at_ms_ = 0;
};

}  // namespace stillpoint::firmware
