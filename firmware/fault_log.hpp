// SPDX-License-Identifier: Apache-2.0
// The last faults, kept over a reset.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "firmware/control_loop.hpp"

namespace stillpoint::firmware {

struct FaultEntry {
  uint16_t code;
  uint16_t counter;  // how often this one has come since the log was empty; stops at its largest
  uint32_t uptime_ms;
  int32_t position;  // counts, at the fault
  int32_t demand;
};

constexpr size_t kFaultEntries = 16;
constexpr size_t kFaultKinds = 16;

// Where a log lives: memory that no start-up code clears, so that it outlasts any reset but a loss of power.
struct FaultMemory {
  uint32_t crc;  // of all that follows
  uint32_t newest;
  uint32_t kinds;
  FaultEntry entry[kFaultEntries];
  struct Kind {
    uint16_t code;
    uint16_t counter;
  } kind[kFaultKinds];
};

// Background.
class FaultLog {
 public:
  // Takes over what is in `memory` where its CRC says that it is a log, else begins an empty one. Null: no log.
  void begin(FaultMemory* memory);

  // Records the loop's fault, once.
  void follow(const LoopSnapshot& loop, uint32_t uptime_ms);

  // Of entry `age`, 0 the newest, word `offset` as in the register map: code, counter, uptime (two), position (two),
  // demand (two), then zeros. All zeros where there is none.
  uint16_t word(uint32_t age, uint32_t offset) const;

 private:
  void record(const FaultEntry& fault);
  uint16_t count(uint16_t code);
  void seal();

  FaultMemory* memory_ = nullptr;
  uint32_t recorded_ = 0;  // the loop's fault_count
};

}  // namespace stillpoint::firmware
