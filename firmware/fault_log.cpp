// SPDX-License-Identifier: Apache-2.0
#include "firmware/fault_log.hpp"

#include "firmware/crc16.hpp"

namespace stillpoint::firmware {
namespace {

// Memory after power-on is noise or zeros; the letters in the upper half keep zeros from passing.
uint32_t crc_of(const FaultMemory& memory) {
  constexpr size_t kBytes = sizeof(FaultMemory) - sizeof memory.crc;
  const auto* const from = reinterpret_cast<const uint8_t*>(&memory) + sizeof memory.crc;
  return (uint32_t{0x464C} << 16) | crc16(from, kBytes);
}

}  // namespace

void FaultLog::begin(FaultMemory* memory) {
  memory_ = memory;
  if (memory == nullptr) return;
  if (memory->crc == crc_of(*memory) && memory->newest < kFaultEntries && memory->kinds <= kFaultKinds) return;
  *memory = FaultMemory{};
  seal();
}

void FaultLog::follow(const LoopSnapshot& loop, uint32_t uptime_ms) {
  if (loop.fault_count == recorded_) return;
  recorded_ = loop.fault_count;
  if (memory_ == nullptr) return;
  record({static_cast<uint16_t>(loop.fault), 0, uptime_ms, counts_from_signal(loop.position),
          counts_from_signal(loop.axis.setpoint)});
}

void FaultLog::record(const FaultEntry& fault) {
  memory_->newest = (memory_->newest + 1) % kFaultEntries;
  FaultEntry& entry = memory_->entry[memory_->newest];
  entry = fault;
  entry.counter = count(fault.code);
  seal();
}

uint16_t FaultLog::count(uint16_t code) {
  uint32_t k = 0;
  while (k < memory_->kinds && memory_->kind[k].code != code) ++k;
  if (k == kFaultKinds) return 1;
  if (k == memory_->kinds) memory_->kind[memory_->kinds++] = {code, 0};
  uint16_t& counter = memory_->kind[k].counter;
  if (counter < UINT16_MAX) ++counter;
  return counter;
}

void FaultLog::seal() { memory_->crc = crc_of(*memory_); }

uint16_t FaultLog::word(uint32_t age, uint32_t offset) const {
  if (memory_ == nullptr) return 0;
  const FaultEntry& entry = memory_->entry[(memory_->newest + kFaultEntries - age) % kFaultEntries];
  const uint32_t wide[] = {entry.uptime_ms, static_cast<uint32_t>(entry.position), static_cast<uint32_t>(entry.demand)};
  if (offset == 0) return entry.code;
  if (offset == 1) return entry.counter;
  if (offset >= 8) return 0;
  const uint32_t value = wide[(offset - 2) / 2];
  return static_cast<uint16_t>(offset % 2 == 0 ? value >> 16 : value);
}

}  // namespace stillpoint::firmware
