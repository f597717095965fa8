// SPDX-License-Identifier: Apache-2.0
// What a shaper on the ticks should have of its prototype: humps, and the edges of its band. Background.
#pragma once

#include "shaper/shaping/meanwhile.hpp"
#include "shaper/shaping/peak.hpp"
#include "shaper/shaping/prototype.hpp"

namespace stillpoint {

// Up to this many cycles a tick (100 Hz at 1 ms) humps and edges are kept from both sides; above, where a period has
// too few ticks for that, no hump may be higher than the tolerance and the band no narrower.
constexpr double kTwoSidedCyclesATick = 0.1;

constexpr double kHighestEdge = 6.0;  // over the mode's frequency; edges above are not looked for

enum class PointKind : uint8_t {
  kHump,  // the top between two zeros
  kEdge,  // where the prototype leaves the tolerance
  kLobe   // a top beyond the zeros that all but touches the tolerance: it makes or breaks the band
};

struct BandPoint {
  PointKind kind;
  double ratio;  // frequency over the mode's
  double log_residual;
  double tolerance;  // of ln V: a fifth of what is asked (1e-3 of V in a hump, 1 % in an edge)
};

struct BandTargets {
  static constexpr size_t kMaxPoints = kMaxZeros + 3;
  bool two_sided;
  double log_tolerance;
  uint32_t count;
  BandPoint points[kMaxPoints];  // humps first, that between zeros i and i + 1 at i

  void add(const BandPoint& point) {
    if (count < kMaxPoints) points[count++] = point;
  }
};

// Cost: about 300 evaluations of the prototype.
BandTargets band_targets(const Prototype& prototype, double damping_ratio, double tolerance, double cycles_a_tick,
                         const Meanwhile& meanwhile = {});

}  // namespace stillpoint
