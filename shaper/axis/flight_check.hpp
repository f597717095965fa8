// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/axis/blend_window.hpp"
#include "shaper/profile/track.hpp"
#include "shaper/shaping/shaper.hpp"

namespace stillpoint {

// Where a mean of the input's past is not known to keep the limits (gains below zero, a profile sped up for zero delay)
// a hand-over from one track to another is looked at tick by tick, in the tick's own integers.
constexpr uint32_t kLongestFlightCheckTicks = UINT32_C(1) << 13;

// The first limit that the shaped stream breaks from the hand-over on until it stands or cruises; kNone if it keeps
// all; kDuration where that takes longer than kLongestFlightCheckTicks. The limits are `limits` once the profile has
// been inside them for as long as the shaper remembers, until then `before_too`. Which way they call forward does not
// matter if they are as wide both ways. `scratch`'s line is overwritten. Cost: a shaper tick for each tick of `next`
// and twice the shaper's length. Background.
struct FlightLimits {
  BlendLimits limits;
  BlendLimits before_too;
};
Quantity broken_in_flight(const Track& before, uint32_t at, const Track& next, const FlightLimits& limits,
                          Shaper& scratch);

}  // namespace stillpoint
