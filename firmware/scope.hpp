// SPDX-License-Identifier: Apache-2.0
// What the tick sees, recorded for a client (registers 0300 on, window 0400 on).
#pragma once

#include <stdint.h>

#include "firmware/control_loop.hpp"
#include "firmware/parameters.hpp"
#include "shaper/identify/capture.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint::firmware {

// Up to four channels (030A on, those before the first 0), each any ScopeSource, a sample every `decimation` ticks, the
// last value of them; 2048 samples in all, shared by the channels. Armed, it fills its pre-trigger part and waits; a
// trigger that comes before that part is full makes the record shorter by what is missing. Full, it keeps the record
// until it is armed again, stopped, or loses the memory.
//
// The memory is the tuner's: while a tuning has it the scope cannot be armed, and the start of a tuning takes it away,
// record and all, also where its plan is refused. What follows the modes (0250) waits until the scope is stopped.
//
// `tick` is the tick's, everything else the background's. Zero-initialised storage is valid.
class Scope {
 public:
  // `memory` null: this drive has no scope.
  void begin(TuneMemory* memory, Parameters& parameters, uint32_t ticks_per_second);

  // Register 0300, with the registers as they will be once the write that it comes in is done. False where it is
  // refused, and nothing has happened then: the reason is in 0012.
  bool command(ScopeCommand command, const Parameters& staged);

  // Brings the registers up to date.
  void show();

  bool full() const { return state() == CaptureState::kFull; }

  // Of a full record, word `offset` of the window with the page in 0311: high byte the channel, low byte the block of
  // kScopePage samples. 0 where there is no such sample.
  uint16_t word(uint32_t offset) const;

  // --- tick -------------------------------------------------------------------------------------------------------

  // After all else in the tick. Bounded; no division, no floating point. Unarmed two loads.
  void tick(const LoopSnapshot& now, const TuneSample& sample);

 private:
  struct Seen {  // by the tick before
    Signal demand;
    Signal setpoint;
    int32_t level;  // of the channel that triggers
    uint32_t fault_count;
    bool moving;
  };

  CaptureState state() const;
  void stop();
  uint16_t reason_against(ScopeCommand command) const;
  Status start(const Parameters& staged);
  int32_t value_of(ScopeSource source, const LoopSnapshot& now, const TuneSample& sample) const;
  bool is_triggered(const Seen& now) const;

  TuneMemory* memory_ = nullptr;
  Parameters* parameters_ = nullptr;
  uint32_t ticks_per_second_ = 0;
  Capture capture_ = {};
  ScopeSource source_[kMaxChannels] = {};
  uint32_t channels_ = 0;
  ScopeTrigger trigger_ = ScopeTrigger::kByHand;
  uint32_t trigger_channel_ = 0;
  ScopeEdge edge_ = ScopeEdge::kRising;
  int32_t level_ = 0;
  uint32_t after_ = 0;  // samples from the trigger on
  // The tick's own, but for `start`, which finds it unarmed.
  bool has_seen_ = false;
  Seen seen_ = {};
};

}  // namespace stillpoint::firmware
