// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "firmware/target/stm32f405/registers.hpp"
#include "hal/nonvolatile.hpp"

namespace stillpoint::stm32f405 {

// RM0090 3.6 and 3.9, against any registers. Both say whether the flash did it: a controller that does not take what is
// written to it, that reports an error or that stays busy did not. Every wait is bounded.
//
// An erase of 128 KB takes 1 to 2 s (DS8626, table 40), in which the flash cannot be read: interrupts are masked, the
// wait runs from RAM and feeds the watchdog. So no tick comes; only for a drive that is disabled. A word takes 16 us,
// in which code that is fetched from flash simply stands.
bool erase_sector(Flash& registers, Iwdg& watchdog, uint32_t sector);
bool program_word(Flash& registers, Register& at, uint32_t word);

// The stored parameters' pages: sectors 10 and 11, which linker.ld keeps the image out of. The emulator has the memory
// and no controller: there erases and words fail. Not tried on silicon yet.
class ParameterFlash final : public hal::Nonvolatile {
 public:
  static constexpr uintptr_t kBegin = 0x080C0000;
  static constexpr size_t kPages = 2;
  static constexpr size_t kPageBytes = 128 * 1024;

  size_t page_count() const override { return kPages; }
  size_t page_bytes() const override { return kPageBytes; }
  bool read(size_t page, size_t offset, uint8_t* to, size_t bytes) const override;
  bool erase(size_t page) override;
  bool program(size_t page, size_t offset, uint32_t word) override;
};

}  // namespace stillpoint::stm32f405
