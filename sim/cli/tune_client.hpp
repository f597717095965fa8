// SPDX-License-Identifier: Apache-2.0
// The firmware's auto-tune from a Modbus client's side, however its registers are reached.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "firmware/registers.hpp"
#include "shaper/tune/auto_tune.hpp"
#include "sim/cli/chip_client.hpp"
#include "sim/cli/register_values.hpp"

namespace stillpoint::cli {

class TuneClient {
 public:
  explicit TuneClient(sim::RegisterPort& port) : client_(port) {}

  // Throws a Refusal with the drive's own reason where it does not take them, or does not start.
  void start(const TuneRegisters& registers);
  void command(firmware::TuneCommand command);
  // Whether that is what the drive refused last.
  bool has_no_tuner();

  // As the drive has them now.
  TuneRegisters registers();

  // Asks until the tuning has ended, or `on_state`, which sees each state read and the part done of 1, says that it is
  // enough. The state then. Throws a Refusal for a fault, or where no end comes in time.
  using OnState = std::function<bool(TuneState, double part_done)>;
  TuneState run(const OnState& on_state);

  // Counts; in the report the sensor's raw steps too, but amplitudes of the modes over the strongest one's.
  Announcement announced();
  TuneReport report();
  // As the registers 0100 have them: once they are kept, what was proposed.
  std::vector<sim::SpecifiedShaper> shapers();

  ChipClient& client() { return client_; }

 private:
  template <typename Write>
  void or_with_reason(const Write& write);
  IdentifiedMode mode(uint32_t k);

  ChipClient client_;
};

}  // namespace stillpoint::cli
