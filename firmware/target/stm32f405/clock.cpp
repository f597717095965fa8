// SPDX-License-Identifier: Apache-2.0
#include "firmware/target/stm32f405/clock.hpp"

#include "firmware/target/stm32f405/registers.hpp"

namespace stillpoint::stm32f405 {
namespace {

// RM0090 7.3.2: source / M to 1 MHz, times N = 336, over P = 2 (bits 00): 168 MHz; Q = 7: 48 MHz.
constexpr uint32_t kPllFactors = 336u << 6 | 7u << 24;
constexpr uint32_t kPllFromCrystal = 8u | kPllFactors | Rcc::kPllcfgrSourceHse;
constexpr uint32_t kPllFromInternal = 16u | kPllFactors;

constexpr uint32_t kFullSpeedHz = 168000000;
constexpr uint32_t kInternalHz = 16000000;

// A crystal takes about 2 ms to start, the PLL 0.3 ms (datasheet DS8626, tables 34 and 38). One turn of the loop is at
// least 6 cycles, so this is above 15 ms at 16 MHz.
constexpr uint32_t kLongestWait = 40000;

bool wait_for(const Register& reg, uint32_t mask, uint32_t wanted) {
  for (uint32_t i = 0; i < kLongestWait; ++i) {
    if ((reg & mask) == wanted) return true;
  }
  return false;
}

// Leaves the core on the PLL, or says false and leaves it where it was.
bool run_from_pll(uint32_t configuration) {
  Rcc& r = rcc();
  r.CR = r.CR & ~Rcc::kCrPllOn;
  if (!wait_for(r.CR, Rcc::kCrPllReady, 0)) return false;
  r.PLLCFGR = configuration;
  r.CR = r.CR | Rcc::kCrPllOn;
  if (!wait_for(r.CR, Rcc::kCrPllReady, Rcc::kCrPllReady)) return false;
  // 5 wait states are for 168 MHz at 2.7-3.6 V (RM0090 3.5.1); the buses' dividers before the speed that needs them.
  flash().ACR = Flash::kAcrLatency5 | Flash::kAcrPrefetch | Flash::kAcrInstructionCache | Flash::kAcrDataCache;
  if (!wait_for(flash().ACR, Flash::kAcrLatencyMask, Flash::kAcrLatency5)) return false;
  r.CFGR = (r.CFGR & ~Rcc::kCfgrSwitchMask) | Rcc::kCfgrApb1By4 | Rcc::kCfgrApb2By2;
  r.CFGR = r.CFGR | Rcc::kCfgrSwitchPll;
  return wait_for(r.CFGR, Rcc::kCfgrStatusMask, Rcc::kCfgrStatusPll);
}

}  // namespace

Clock start_clock() {
  constexpr Clock kFull{ClockSource::kCrystalPll, kFullSpeedHz, kFullSpeedHz / 4, kFullSpeedHz / 2};
  Rcc& r = rcc();
  r.CR = r.CR | Rcc::kCrHsiOn | Rcc::kCrHseOn;
  Clock clock = kFull;
  if (wait_for(r.CR, Rcc::kCrHseReady, Rcc::kCrHseReady) && run_from_pll(kPllFromCrystal)) return clock;
  if (!wait_for(r.CR, Rcc::kCrHsiReady, Rcc::kCrHsiReady)) {
    clock.source = ClockSource::kUnanswered;
    return clock;
  }
  if (run_from_pll(kPllFromInternal)) {
    clock.source = ClockSource::kInternalPll;
    return clock;
  }
  r.CFGR = 0;  // the internal oscillator, no dividers
  return {ClockSource::kInternal, kInternalHz, kInternalHz, kInternalHz};
}

}  // namespace stillpoint::stm32f405
