// SPDX-License-Identifier: Apache-2.0
// Shapers as the literature has them: impulses anywhere in time. Background; doubles.
#pragma once

#include "shaper/base/status.hpp"
#include "shaper/shaping/meanwhile.hpp"
#include "shaper/shaping/response.hpp"
#include "shaper/shaping/shaper_spec.hpp"

namespace stillpoint {

constexpr size_t kMaxZeros = 5;

// A mode that a shaper leaves still.
struct Zero {
  double ratio;  // frequency, over that of the mode designed for
  double damping_ratio;
};

// Time in periods 1/f of the undamped mode, so that it depends on damping, tolerance and spacing alone.
struct Prototype {
  Cascade train;
  uint32_t zero_count;
  Zero zeros[kMaxZeros];  // rising; of a cascade of ZV shapers: part i's own
  bool is_cascade;        // each part is the ZV shaper of its zero
  bool is_banded;         // zeros stand around the mode to make a band, and may be moved to fit it on the grid
};

// Designs `spec` (with its defaults, valid). ZV to ZVDDD: binomial amplitudes, factor by factor; MZV: three impulses
// `spacing` damped periods apart, 1 : -2 cos(2 pi spacing) K : K^2 with K = exp(-2 pi zeta spacing / sqrt(1-zeta^2)),
// which is ZV at 1/4 and ZVD at 1/2; UM-ZV: +1 -1 +1, times by Newton; EI and CV: see the functions below; custom: the
// train as it is. Refuses kAboveMaximum kTolerance, with one that has a solution, where a damped EI or CV of this
// tolerance does not exist.
Status make_prototype(const ShaperSpec& spec, Prototype& out, const Meanwhile& meanwhile = {});

// Park 2001: h + 1 ZV shapers at (1 -+ k_i) f and, when h + 1 is odd, at f; k such that each hump from the bottom up to
// the middle is `tolerance`. k at most 0.95. Newton on the logarithms of the humps from Chebyshev's offsets, at most
// 40 steps; where that fails, in steps of the tolerance. Refuses as above (most seen on the way: 65 Newton runs where
// it refuses, 17 where not).
Status make_convolution(uint32_t humps, double damping_ratio, double tolerance, Prototype& out,
                        const Meanwhile& meanwhile = {});

// n humps, n + 2 impulses, n + 1 zeros of the damped mode, each hump `tolerance`, a hump (n odd) or a zero (n even) at
// the mode: reference EI without its curve fits. Newton on 3 n + 4 unknowns, continued in damping from the undamped
// closed form in steps of at most 0.05. Refuses as above.
Status make_extra_insensitive(uint32_t humps, double damping_ratio, double tolerance, Prototype& out,
                              const Meanwhile& meanwhile = {});

}  // namespace stillpoint
