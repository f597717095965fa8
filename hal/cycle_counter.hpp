// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

namespace stillpoint::hal {

// A free-running counter of processor cycles (or of instructions, in an emulator that counts those). Wraps.
class CycleCounter {
 public:
  virtual uint32_t now() const = 0;

 protected:
  ~CycleCounter() = default;
};

}  // namespace stillpoint::hal
