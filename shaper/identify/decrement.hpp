// SPDX-License-Identifier: Apache-2.0
// Li 2017's identification, as published: the yardstick of identify(). Background.
#pragma once

#include "shaper/base/status.hpp"
#include "shaper/identify/fft.hpp"
#include "shaper/identify/record.hpp"

namespace stillpoint {

struct DecrementConfig {
  double rate_hz = 0.0;
  double low_pass_hz = 0.0;  // second-order Butterworth; 0: four tenths of the rate
  double threshold = 0.3;    // A_v: amplitude of a peak over the highest one's
  double merge_hz = 0.0;     // w_v: peaks nearer than this are one; 0: three bins
  size_t most_modes = 3;
};

struct DecrementMode {
  double frequency_hz;  // natural
  double damping_ratio;
  double amplitude;  // of the spectrum's peak
};

constexpr size_t kMostDecrementModes = 4;

struct DecrementModes {
  size_t count;
  DecrementMode mode[kMostDecrementModes];  // highest peak first
};

// Straight line off, low-pass, power spectrum, peaks above a threshold, close ones merged; each band-passed;
// logarithmic decrement of successive maxima and of successive minima, averaged; f = fd / sqrt(1 - zeta^2) with fd the
// peak's bin. What the paper leaves open: the band-pass is of second order and a third of fd wide, each half-wave has
// one extremum, the first is left to the transient, and the decrement ends where the ringing has fallen to a twentieth.
// Refuses a rate, threshold or count out of range and a record longer than `buffer`, `size` a power of two.
// Source: Li 2017, section 2 (reference page, 6).
Status identify_by_decrement(const Record& record, const DecrementConfig& config, double* buffer, size_t size,
                             DecrementModes& modes);

}  // namespace stillpoint
