// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/base/status.hpp"
#include "shaper/shaping/response.hpp"

namespace stillpoint {

// What is known of a mode: somewhere in here.
struct ModeBand {
  double low_hz;
  double high_hz;
  double low_damping;
  double high_damping;

  // Refuses, naming the nearest value accepted: anything not finite, low_hz not above zero, high_hz not above low_hz or
  // not below half the tick rate, damping outside [0, kMaxDampingRatio] or falling.
  Status validate(double tick_s) const;
};

struct WorstResidual {
  double residual;
  double frequency_hz;
  double damping_ratio;
};

// The largest residual that taps on the ticks (times of `taps` in ticks) leave of a mode anywhere in the band. V is the
// magnitude of an analytic function of the pole, so its largest value lies on the band's outline: either damping along
// all frequencies, either frequency at nine dampings. Sampled 32 times a wave of the shaper's length, tops refined.
// Cost: about 64 (high - low) length + 100 evaluations.
WorstResidual worst_residual(const Cascade& taps, const ModeBand& band, double tick_s);

}  // namespace stillpoint
