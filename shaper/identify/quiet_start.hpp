// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/identify/record.hpp"

namespace stillpoint {

// The first sample of `position` (of the axis, any unit) from which on it rests: within `window` samples it never
// again moves by more than a hundredth of the most it moved in as many, and two windows have passed since. `count`
// where it never rests so, 0 where it never moves. When a decay starts matters more than how it is fitted, and the
// reference says too little: on a flexible link a fit from where the reference stood gave 1.29 Hz and a damping of
// 0.18, one from where the hub stood, up to a second later, 1.84 Hz and 0.027. Background; cost 2 comparisons a
// sample and window. About 0.1 s is a good window.
size_t quiet_start(const Record& position, size_t window);

}  // namespace stillpoint
