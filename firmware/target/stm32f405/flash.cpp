// SPDX-License-Identifier: Apache-2.0
#include "firmware/target/stm32f405/flash.hpp"

// Code in RAM is out of a branch's reach; on the host there is neither.
#if defined(__arm__)
#define STILLPOINT_RAM_CODE __attribute__((section(".ram_code"), noinline, long_call))
#else
#define STILLPOINT_RAM_CODE
#endif

namespace stillpoint::stm32f405 {
namespace {

constexpr uint32_t kFirstSector = 10;

// One turn of either loop is at least 6 cycles of at most 168 MHz: an erase is given above 4 s, a word above 3 ms.
constexpr uint32_t kLongestErase = 120000000;
constexpr uint32_t kLongestWord = 100000;

uint32_t mask_interrupts() {
  uint32_t before = 0;
#if defined(__arm__)
  __asm__ volatile("mrs %0, primask\n cpsid i" : "=r"(before)::"memory");
#endif
  return before;
}

void unmask_interrupts([[maybe_unused]] uint32_t before) {
#if defined(__arm__)
  __asm__ volatile("msr primask, %0" ::"r"(before) : "memory");
#endif
}

STILLPOINT_RAM_CODE bool erase_and_wait(Flash& registers, Iwdg& watchdog) {
  registers.CR = registers.CR | Flash::kCrStart;
  for (uint32_t i = 0; i < kLongestErase; ++i) {
    watchdog.KR = Iwdg::kKeyFeed;
    if ((registers.SR & Flash::kSrBusy) == 0) return true;
  }
  return false;
}

// Bounded wait for what was under way; then unlocked, without errors, set up for `operation`.
bool prepare(Flash& registers, uint32_t operation) {
  for (uint32_t i = 0; (registers.SR & Flash::kSrBusy) != 0; ++i) {
    if (i == kLongestWord) return false;
  }
  if ((registers.CR & Flash::kCrLock) != 0) {
    registers.KEYR = Flash::kKey1;
    registers.KEYR = Flash::kKey2;
  }
  const uint32_t errors = registers.SR;
  registers.SR = errors;  // a one clears
  registers.CR = operation;
  return registers.CR == operation;
}

bool finish(Flash& registers, bool in_time) {
  const bool good = in_time && (registers.SR & Flash::kSrErrors) == 0;
  registers.CR = Flash::kCrLock;
  return good;
}

// The data cache knows nothing of an erase (RM0090 3.5.2); it can only be reset while it is off.
void forget_cached_data(Flash& registers) {
  const uint32_t with = registers.ACR;
  registers.ACR = with & ~Flash::kAcrDataCache;
  registers.ACR = (with & ~Flash::kAcrDataCache) | Flash::kAcrDataCacheReset;
  registers.ACR = with;
}

Register& word_of(size_t page, size_t offset) {
  return *reinterpret_cast<Register*>(ParameterFlash::kBegin + page * ParameterFlash::kPageBytes + offset);
}

}  // namespace

bool erase_sector(Flash& registers, Iwdg& watchdog, uint32_t sector) {
  if (!prepare(registers, Flash::kCrSectorErase | Flash::kCrWords | sector << Flash::kCrSectorShift)) return false;
  const uint32_t interrupts = mask_interrupts();
  const bool in_time = erase_and_wait(registers, watchdog);
  const bool good = finish(registers, in_time);
  forget_cached_data(registers);
  unmask_interrupts(interrupts);
  return good;
}

bool program_word(Flash& registers, Register& at, uint32_t word) {
  if (!prepare(registers, Flash::kCrProgram | Flash::kCrWords)) return false;
  at = word;
  bool in_time = false;
  for (uint32_t i = 0; i < kLongestWord && !in_time; ++i) in_time = (registers.SR & Flash::kSrBusy) == 0;
  return finish(registers, in_time) && at == word;
}

bool ParameterFlash::read(size_t page, size_t offset, uint8_t* to, size_t bytes) const {
  const auto* from = reinterpret_cast<const volatile uint8_t*>(&word_of(page, offset));
  for (size_t i = 0; i < bytes; ++i) to[i] = from[i];
  return true;
}

bool ParameterFlash::erase(size_t page) {
  return erase_sector(flash(), iwdg(), kFirstSector + static_cast<uint32_t>(page));
}

bool ParameterFlash::program(size_t page, size_t offset, uint32_t word) {
  return program_word(flash(), word_of(page, offset), word);
}

}  // namespace stillpoint::stm32f405
