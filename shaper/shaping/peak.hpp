// SPDX-License-Identifier: Apache-2.0
// Where a residual's humps stand, and where it leaves the tolerance. Background.
#pragma once

#include "shaper/shaping/response.hpp"

namespace stillpoint {

struct Peak {
  double frequency;
  double log_residual;
};

// The top of the hump between two neighbouring zeros (or deep minima) of the residual. Damped ZV factors have further
// minima at odd multiples of their zeros, so a hump may have several tops, some nearly as high: 11 points are looked
// at, 60 in a hump so wide (beyond 1.6 times `low`) that it may hold such a minimum, and the highest is refined. (With
// 11 there too, 10 of 7440 convolutions had a hump up to 3 % above the tolerance.) Bounded: at most 25 evaluations
// more, usually 5.
// Method: the slope of ln V runs from +1/(x - low) to -1/(high - x), so slope times both distances is nearly linear
// about the top: false position on it, with the Illinois weight. The height errs by the square of the frequency's
// error, below 1e-13.
Peak peak_between(const Cascade& cascade, double damping_ratio, double low, double high);

// The top of a lobe between two frequencies, or the higher of them where there is none. At most 27 evaluations.
Peak peak_near(const Cascade& cascade, double damping_ratio, double low, double high);

// Where the residual first rises through exp(log_tolerance) on the way from `inside`, where it is below, towards
// `limit`: steps of `step`, then bisection to 1e-12. `limit` itself where it does not get there. A lobe narrower than a
// step may be missed. Cost: (distance / step + 45) evaluations.
double edge_towards(const Cascade& cascade, double damping_ratio, double log_tolerance, double inside, double limit,
                    double step);

}  // namespace stillpoint
