// SPDX-License-Identifier: Apache-2.0
// One axis end to end: target -> profile -> shaping -> setpoint.
//
// Who may call what. The *tick* context is the one place that calls `tick`, normally an interrupt; the *background*
// is everything it interrupts. Background functions may be interrupted by `tick` at any instruction; `tick` is never
// interrupted by them.
//   - The tick owns the sampler, the stop ramp, the active line and the published state.
//   - The background owns the spare track until it has filled it and set `pending_move_`; from then on it is the
//     tick's, until the tick clears that. The same with the spare line and `pending_`. Both are 32 bits, written last,
//     read first. What waits of a move the background may take back by clearing the word itself.
//   - The track in force is only read, by both; while no move is pending no other takes its place.
//   - In a blend the spare shaper and its line run beside the active ones; `pending_` stays set until it is over, and
//     the pairs change places in that tick.
//   - A pending shaper that waits for rest comes back to the background while `looking_` is set: the tick, which cannot
//     be half-way through when the background runs, then takes nothing.
//   - 64-bit values go from the tick to the background in a snapshot that is read again if a tick came between.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/axis/axis_config.hpp"
#include "shaper/axis/axis_core.hpp"
#include "shaper/shaping/shaper.hpp"

namespace stillpoint {

// kLineCapacity: LineSamples that a shaper may take (Shaper::memory_needed: a stage of d ticks and t taps d + t + 2).
// RAM: 16 bytes each (two shapers: the active one and the one being prepared) and about 1 KB.
template <size_t kLineCapacity>
class Axis : public AxisCore {
  static_assert(kLineCapacity >= 7, "room for the shortest stage");
  static_assert(kLineCapacity <= (size_t{1} << 20), "longer lines than 8 MB a shaper are a mistake");

 public:
  // As AxisCore::configure; the first call also gives the core its lines. (Not in a constructor: a static Axis is all
  // zeros and costs no flash.)
  Status configure(const AxisConfig& config) {
    attach(line_memory_[0], line_memory_[1], kLineCapacity);
    return AxisCore::configure(config);
  }

 private:
  LineSample line_memory_[2][kLineCapacity] = {};
};

}  // namespace stillpoint
