// SPDX-License-Identifier: Apache-2.0
// Shapers exchanged in the middle of a stream that is known to its end.
#pragma once

#include <cstddef>
#include <vector>

#include "shaper/base/signal.hpp"
#include "shaper/profile/limits.hpp"
#include "shaper/shaping/design.hpp"

namespace stillpoint::sim {

struct StreamRetune {
  size_t tick;
  ShaperDesign design;
};

struct RetunedStream {
  std::vector<Signal> output;       // until the last value has arrived
  std::vector<size_t> active_from;  // per retune that came due, in order: the first tick of its shaper alone
};

// Shapes `input`, which stands at 0 before and at its last value ever after. A retune takes effect at rest, from its
// tick on, or is blended in before that: the new shaper first runs beside the old for its own length, then the output
// goes over where that keeps `limits` (counts/s^n). Where one of the two streams breaks a limit by itself, as steps of
// whole counts do, the blend may go as far as they do within its own window. One retune after the other.
RetunedStream retuned(const std::vector<Signal>& input, const ShaperDesign& first,
                      const std::vector<StreamRetune>& retunes, const AxisLimits& limits, double tick_s);

}  // namespace stillpoint::sim
