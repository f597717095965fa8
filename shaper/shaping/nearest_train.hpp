// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/shaping/response.hpp"

namespace stillpoint {

enum class Placed : uint8_t { kYes, kTooManyTaps, kCannot };

// A train on the ticks, as near to itself as it can be: split linearly over the ticks on either side of each impulse,
// then changed as little as possible (least squares over the gains) so that the transfer at the mode is what the
// impulses have there; none, if they leave less than kZeroByDesign. Impulses on whole ticks whose transfer is right
// stay as they are. Where the ticks of the train cannot turn the transfer, the next free ones are used too. Time in
// periods of the mode; `out` in ticks. Background.
constexpr double kZeroByDesign = 1e-3;
Placed nearest_train(const Cascade& train, double damping_ratio, double cycles_a_tick, Cascade& out);

}  // namespace stillpoint
