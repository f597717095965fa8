// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/flight_check.hpp"

namespace stillpoint {

Quantity broken_in_flight(const Track& before, uint32_t at, const Track& next, const FlightLimits& limits,
                          Shaper& scratch) {
  // Fed for its length the line holds what it holds on the axis; three ticks more give the differences.
  const uint32_t settle = scratch.length_ticks() + 3;
  if (settle > kLongestFlightCheckTicks || next.duration_ticks > kLongestFlightCheckTicks - settle)
    return Quantity::kDuration;
  const bool forward = limits.limits.forward;
  Sampler sampler;
  uint32_t tick = at > settle ? at - settle : 0;
  sampler.begin_at(before, tick);
  Stream profile{sampler.position(), 0, 0, 0};
  Stream shaped = profile;
  scratch.fill(sampler.position());
  for (; tick < at; ++tick) {
    profile.next(sampler.tick(), forward);
    shaped.next(scratch.tick(profile.newest), forward);
  }
  sampler.begin(next);
  uint32_t inside = 0;
  for (uint32_t i = 0; i < next.duration_ticks + settle; ++i) {
    profile.next(sampler.tick(), forward);
    shaped.next(scratch.tick(profile.newest), forward);
    inside = profile.broken(limits.limits) == Quantity::kNone ? inside + 1 : 0;
    const Quantity broken = shaped.broken(inside > settle ? limits.limits : limits.before_too);
    if (broken != Quantity::kNone) return broken;
  }
  return Quantity::kNone;
}

}  // namespace stillpoint
