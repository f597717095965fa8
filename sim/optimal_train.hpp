// SPDX-License-Identifier: Apache-2.0
// The shortest shaper of positive impulses that any method can find for a band: what every other one is measured
// against. Reference 2 quotes its lengths as "an LP limit".
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "shaper/shaping/band_check.hpp"
#include "sim/analysis.hpp"

namespace stillpoint::sim {

struct OptimalTrain {
  uint32_t length_ticks;         // delay of the last tap, from which V is counted
  std::vector<ImpulseTap> taps;  // delays rise from 0 to length_ticks; gains are not negative and sum to one
  double worst_residual;         // the largest V in the band, at most the tolerance
  double shorter_leaves;         // what every positive train of length_ticks - 1 exceeds in the band, by LP duality
};

constexpr double kWidestBand = 20.0;                   // high_hz / low_hz
constexpr uint32_t kLongestTrain = UINT32_C(1) << 20;  // ticks, as kMaxStageTicks
using PartDone = std::function<void(double part_done)>;

// The least N for which gains at the ticks 0..N keep V(w, zeta) of Park (1) at or below `tolerance` all over the band,
// and, of the trains of that length, one whose largest V is the least (to 1e-4 of it). Few of its gains are above zero:
// about as many as V has peaks at its largest. Throws a Refusal: bad_argument for a tolerance outside kMinTolerance to
// kMaxTolerance, a band wider than kWidestBand, damping above kMaxDampingRatio, or a band that reaches half the tick
// rate. Takes 1 to 200 ms for a band of up to a factor of six, whatever the tick; up to 10 s for a factor of 20 at 1 %.
// Decided to 1e-6 of the tolerance: a shorter train within that of it may be missed.
OptimalTrain shortest_positive_train(const ModeBand& band, double tolerance, double tick_s,
                                     const PartDone& part_done = {});

// The same without a grid, in periods of `unit_hz`: from a grid of 1000 ticks a period, so about 0.001 of a period too
// long at most.
double shortest_positive_periods(const ModeBand& band, double tolerance, double unit_hz);

}  // namespace stillpoint::sim
