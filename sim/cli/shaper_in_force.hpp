// SPDX-License-Identifier: Apache-2.0
// The drive's shaper, to be changed for a while and put back.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/cli/chip_client.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

// The registers tell what is staged in a set; that a set is in force is known by its delay.
class ShaperInForce {
 public:
  // Finds the set in force, the shown one first, and shows it. Throws a Refusal where an apply is under way, or where
  // no set's staged modes are what is in force; then nothing has changed.
  explicit ShaperInForce(sim::RegisterPort& port);

  // In force in that set from then on. Waits for it, and for the axis's rest before.
  void replace(const std::vector<ModeRegisters>& modes) { client_.set_shaper(modes); }

  // What was in force is in force again, what was staged staged. Waits for the axis's rest, but not for the end of a
  // fault: nothing comes into force before that.
  void put_back();
  // What is in force stays.
  void keep();

 private:
  bool is_in_force(uint32_t delay_us);
  void show(uint16_t set);

  sim::RegisterPort& port_;
  ChipClient client_;
  uint16_t shown_;
  uint16_t staged_count_ = 0;
  uint16_t count_ = 0;            // of the modes in force
  std::vector<uint16_t> staged_;  // all of the modes' registers
};

}  // namespace stillpoint::cli
