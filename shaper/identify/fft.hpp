// SPDX-License-Identifier: Apache-2.0
// The spectrum of a real record. Background, in place, no tables: the caller's buffer is all the memory.
#pragma once

#include <stddef.h>

namespace stillpoint {

constexpr size_t kLeastFft = 4;
constexpr size_t kLargestFft = 4096;

constexpr bool is_fft_size(size_t size) { return size >= kLeastFft && size <= kLargestFft && (size & (size - 1)) == 0; }

// The smallest size of a transform that holds `count` values, 0 where none does.
constexpr size_t fft_size_for(size_t count) {
  size_t size = kLeastFft;
  while (size < count) size *= 2;
  return size <= kLargestFft ? size : 0;
}

// X_k = sum x_n exp(-2 pi i k n / size), k = 0 .. size / 2. In: `size` reals. Out, in their place: re X_0, re X_size/2,
// then re X_k, im X_k for k = 1 .. size / 2 - 1. False, with nothing touched, unless is_fft_size(size).
// Error: below 4e-16 log2(size) of the root of the sum of squares. Cost: about 3 size log2(size) multiplications and
// additions, and size / 8 sines.
// Method: the even and odd values as one complex transform of half the size, radix 2 (Press et al., Numerical Recipes,
// 3rd ed., 12.2 and 12.3); the twiddle of a stage by recurrence, taken anew every 16 steps.
[[nodiscard]] bool real_fft(double* values, size_t size);

// |X_k|^2 of what real_fft left, in its place: size / 2 + 1 powers, k = 0 .. size / 2.
void to_power(double* values, size_t size);

// Multiplies by the periodic Hann window, (1 - cos(2 pi n / count)) / 2: sum of weights count / 2, of squares 3 count /
// 8. Cost: count / 16 sines.
void apply_hann(double* values, size_t count);

// Where the peak at bin k of a power spectrum stands, in bins: k plus the top of the parabola through the logarithms of
// the three powers; k itself at the ends and where it is no peak. Within 0.18 bins for one sinusoid without a window,
// and 0.02 with Hann's.
double interpolated_peak(const double* power, size_t size, size_t k);

}  // namespace stillpoint
