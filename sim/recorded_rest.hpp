// SPDX-License-Identifier: Apache-2.0
// What a scope has recorded of a rest, told to a tuner tick by tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shaper/tune/auto_tune.hpp"

namespace stillpoint::sim {

// One channel, from the first tick that the axis stands on. Sample n is of tick n * every + every - 1, as the scope
// takes them.
struct RestChannel {
  std::vector<int32_t> samples;
  uint32_t every = 1;  // ticks

  // The sample that stands for a tick; the last one from there on, 0 where there is none.
  int32_t at(uint32_t tick) const;
  size_t ticks() const { return samples.size() * every; }
};

// The channels may be of different records, each of a rest behind a motion of the same kind.
struct RecordedRest {
  RestChannel following_error;  // counts, setpoint less position
  RestChannel acceleration;     // raw

  size_t ticks() const;
  // As the drive's own tick would have seen it where it is given `setpoint`.
  TuneSample at(uint32_t tick, Signal setpoint) const;
};

// Tells a sensor that lives from none.
bool changes(const std::vector<int32_t>& samples);

// Of those that a scope's record of `scope` samples a channel holds, as many as are left where the rest is found as
// late as it may be (see RestWatch); for TuneConfig::samples. 0 where none are.
uint32_t samples_for_tuning(uint32_t scope);

}  // namespace stillpoint::sim
