// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillpoint::hal {

// Resets the chip unless fed in time. Fed from the background, and only when the tick is alive too.
class Watchdog {
 public:
  virtual void feed() = 0;

 protected:
  ~Watchdog() = default;
};

}  // namespace stillpoint::hal
