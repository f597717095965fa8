// SPDX-License-Identifier: Apache-2.0
// From the setpoint of each tick to whole pulses and a direction, for a drive with a pulse input.
#pragma once

#include <stdint.h>

#include "firmware/pulse_timing.hpp"
#include "shaper/base/signal.hpp"
#include "shaper/base/wide.hpp"

namespace stillpoint::firmware {

// The pulses of one tick: all of one direction, `period_cycles` of the timer's clock apart, the first half a period
// after the start.
struct PulseBurst {
  uint32_t count;
  uint32_t period_cycles;  // 0 where count is 0
  bool forward;
  bool reversed;  // the direction is not that of the burst before
};

// Exact: the pulses of all ticks since `align` sum to the rounded (setpoint - aligned setpoint) * pulses / counts,
// halves up, at every tick, as integers and for ever; setpoints wrap as Signals do. But for three things:
//   - What does not fit into a tick (max_frequency_hz; on a reversal also what setup_ns leaves room for) waits for the
//     next ones. Nothing is lost; `limited_ticks` counts.
//   - The reversal gap: a pulse against the direction of the pulse before comes only when the setpoint is a whole pulse
//     away, not half of one, so that a dither around an edge of the rounding moves nothing. It costs up to half a pulse
//     more of error from a reversal until the first pulse in the new direction, and where the setpoint then stands
//     still on a fraction of a pulse; on a whole pulse it always ends exactly. A dither of a whole pulse and more goes
//     through. `without_reversal_gap` leaves it out.
//   - `give_back`.
// Within a tick the pulses are evenly spread, each period within one clock cycle below (tick - hold - jitter) / count;
// across the end of a tick the pause is longer by hold, jitter and less than `count` cycles.
//
// Tick context but for `use`. No division by the compiler's means: a dozen products of 128 bits, and at most 31 turns
// of a shift and a subtraction. Zero-initialised it emits nothing.
class PulseTrain {
 public:
  // Background, while the tick does not run. What `plan_pulses` gave.
  void use(const PulseTiming& timing);

  // The pulses to bring a drive that stands on the setpoint before to this one.
  PulseBurst next(Signal setpoint);

  // The drive stands on this setpoint, by definition. What waited is forgotten.
  void align(Signal setpoint);

  // `burst`, the newest one, was not emitted: it waits for the next tick.
  void give_back(const PulseBurst& burst);

  uint32_t limited_ticks() const { return limited_ticks_; }
  // The newest ticks were limited, `fault_after` of them and more.
  bool faulted() const { return timing_.fault_after != 0 && limited_in_a_row_ >= timing_.fault_after; }

 private:
  uint32_t due() const;
  void owe(int64_t pulses);
  void note_limit(bool limited);

  Wide owed_ = {};   // LSB of the setpoint times `pulses`, not emitted yet; below one pulse but for what waits
  Wide pulse_ = {};  // one pulse, in the same
  PulseTiming timing_ = {};
  Signal setpoint_ = 0;
  uint32_t limited_ticks_ = 0;
  uint32_t limited_in_a_row_ = 0;
  bool moved_ = false;    // since `align`: there is a direction to reverse
  bool forward_ = false;  // of the newest burst that was not given back
};

}  // namespace stillpoint::firmware
