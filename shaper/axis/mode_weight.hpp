// SPDX-License-Identifier: Apache-2.0
// What a change of jerk leaves of a mode, by the samples of the ticks.
#pragma once

#include "shaper/base/complex.hpp"
#include "shaper/shaping/mode.hpp"

namespace stillpoint {

// A mode is at rest after a stream if the stream's transform sum x_n p^-n has a zero at the sampled pole p (reference,
// 3). A change of jerk by one at a time between ticks adds to the third difference of the samples c0, c1, c2 and ever 1
// (see Switch in track.hpp), each times p^-n: closed form. Background; doubles.
class ModeWeight {
 public:
  struct Value {
    Complex value;
    Complex slope;  // a tick
  };

  ModeWeight() = default;
  ModeWeight(const Mode& mode, double tick_s);

  // Of a change at `ticks`. Counted from `end`, about where the move does and the vibration would be largest, so
  // that nothing overflows. Cost: an exp, a sine and a cosine.
  Value at(double ticks, double end) const;

 private:
  Complex exponent_ = {};
  Complex one_ = {};
  Complex two_ = {};
  Complex rest_ = {};
};

}  // namespace stillpoint
