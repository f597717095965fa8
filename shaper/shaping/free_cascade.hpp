// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/shaping/prototype.hpp"

namespace stillpoint {

// The shortest cascade of `count` ZV shapers for a band [1, high] of frequencies: zeros placed freely (Park 2001 keeps
// them symmetric about a mode). Raising a zero shortens its stage, so at the optimum every constraint holds one back:
// V(1) and the top of each hump are `tolerance`; where a zero has gone above the band, V(high) takes the place of the
// hump below it. Newton on the logarithms from Chebyshev's zeros for an open band, then continued in `high`.
// False where `count` zeros cannot hold the band, or where fewer can with the last one going to infinity. Time and
// frequency in any unit and its reciprocal. Background; at most 400 Newton steps, 30 mostly.
[[nodiscard]] bool make_free_cascade(uint32_t count, double high, double damping_ratio, double tolerance,
                                     Prototype& out);

}  // namespace stillpoint
