// SPDX-License-Identifier: Apache-2.0
// Does a decay keep its damping while it dies? Background.
#pragma once

#include "shaper/identify/decomposition.hpp"

namespace stillpoint {

// Decay and angle of one component in the first part of its record and in the rest, both in the units of the whole.
struct TwoParts {
  bool known;  // false where one of them was too short, or nothing was left to fit
  double decay[2];
  double angle[2];
  double decay_std[2];
  double angle_std[2];
};

// Fits component k by itself in two parts of the record, the other components taken off: up to where it has fallen to
// 1/e or the middle of the record, and from there. Friction that does not grow with speed shows as damping that rises
// towards the end, a large swing as damping (or frequency) that falls. `colour`: the noise about the component over its
// mean. Cost: two fits of one component.
TwoParts fit_two_parts(const Record& record, const DecayModel& model, size_t k, double colour, DecayFit& fit,
                       const Meanwhile& meanwhile);

}  // namespace stillpoint
