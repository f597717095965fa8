// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware/target/stm32f405/registers.hpp"
#include "hal/watchdog.hpp"

namespace stillpoint::stm32f405 {

// The independent watchdog, on its own oscillator; once started only a reset stops it. 2 s at 32 kHz, 1.4 to 3.8 s over
// the oscillator's 17 to 47 kHz (DS8626, table 36): longer than the longest plan the background computes between two
// feeds. The drive does not wait for it: three syncs without an answer are enough for the other side.
// QEMU has no such watchdog: shown on silicon only, and not yet.
class IndependentWatchdog final : public hal::Watchdog {
 public:
  void start() {
    iwdg().KR = Iwdg::kKeyStart;
    iwdg().KR = Iwdg::kKeyUnlock;
    iwdg().PR = Iwdg::kPrescaleBy64;
    iwdg().RLR = kReload;
    for (uint32_t i = 0; i < kLongestWait && (iwdg().SR & Iwdg::kSrBusy) != 0; ++i) {
    }
    feed();
  }

  void feed() override { iwdg().KR = Iwdg::kKeyFeed; }

 private:
  static constexpr uint32_t kReload = 1000;         // of 64 / 32 kHz = 2 ms
  static constexpr uint32_t kLongestWait = 100000;  // the registers take five periods of 32 kHz
};

}  // namespace stillpoint::stm32f405
