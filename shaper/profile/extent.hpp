// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/profile/plan.hpp"

namespace stillpoint {

// How far a plan leads from its start, both ways, in its position unit: lowest <= 0 <= highest. Of a plan that turns
// round on its way this is more than its distance.
struct Extent {
  double lowest;
  double highest;
};

// Of a plan of segments; it may begin in motion. Background; two square roots a segment at most.
Extent extent_of(const Plan& plan);

}  // namespace stillpoint
