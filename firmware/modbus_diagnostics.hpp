// SPDX-License-Identifier: Apache-2.0
// Function 8, diagnostics of a serial line (V1.1b3, 6.8): sub-functions 0, 1, 4, 10 to 18.
#pragma once

#include "firmware/modbus_pdu.hpp"
#include "firmware/modbus_rtu.hpp"

namespace stillpoint::firmware::modbus {

// Background. Zero-initialised storage is valid.
class Diagnostics {
 public:
  // Function 8. `line` has the counters as they are now, with the request that is asked.
  ModbusException execute(const RtuCounters& line, Exchange& exchange);

  // Nothing is executed and nothing answered, but for the restart that ends this.
  bool listen_only() const { return listen_only_; }
  void answer_again() { listen_only_ = false; }
  // Whether that is what it asks for.
  static bool restarts(const Exchange& exchange);

 private:
  static constexpr uint32_t kCounters = 8;

  static uint32_t raw(const RtuCounters& line, uint32_t index);
  void clear(const RtuCounters& line);

  bool listen_only_ = false;
  uint32_t cleared_at_[kCounters] = {};
};

}  // namespace stillpoint::firmware::modbus
