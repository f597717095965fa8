// SPDX-License-Identifier: Apache-2.0
// Zeros, humps and band of a sensitivity curve from its values alone, so that one ruler measures what is calculated and
// what a plant did.
#pragma once

#include <functional>
#include <vector>

#include "sim/analysis.hpp"

namespace stillpoint::sim {

// Residual vibration ratio at a frequency [Hz], at least zero.
using ResidualCurve = std::function<long double(double)>;

// Frequencies in [low_hz, high_hz] at which the curve falls to below 1e-6, rising. Two of them closer than `step_hz`
// may be taken for one. A damped ZV shaper's minima at odd multiples of its zero are none.
std::vector<double> zeros_of(const ResidualCurve& curve, double low_hz, double high_hz, double step_hz);

// The highest hump between two zeros; 200 values are looked at, the highest is refined.
double hump_between(const ResidualCurve& curve, double low_hz, double high_hz);

// The contiguous band around frequency_hz with at most `tolerance`, as ratios to it, looked for within the limits of
// `within`. Humps of up to 2 % more pass: a shaper's own, which the tick grid may leave a little high.
Band band_of(const ResidualCurve& curve, double frequency_hz, double tolerance, const Band& within);

}  // namespace stillpoint::sim
