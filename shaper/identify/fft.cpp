// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/fft.hpp"

#include "shaper/identify/rotor.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;

void swap_pair(double* a, double* b) {
  for (int part = 0; part < 2; ++part) {
    const double kept = a[part];
    a[part] = b[part];
    b[part] = kept;
  }
}

// `points` complex values, in place, in the order that the stages want.
void reverse_bits(double* values, size_t points) {
  size_t reversed = 0;
  for (size_t n = 1; n < points; ++n) {
    size_t bit = points >> 1;
    for (; (reversed & bit) != 0; bit >>= 1) reversed ^= bit;
    reversed |= bit;
    if (n < reversed) swap_pair(values + 2 * n, values + 2 * reversed);
  }
}

void complex_fft(double* values, size_t points) {
  reverse_bits(values, points);
  for (size_t half = 1; half < points; half *= 2) {
    Rotor twiddle({0.0, -kPi / static_cast<double>(half)});
    for (size_t j = 0; j < half; ++j, twiddle.advance()) {
      const Complex w = twiddle.value();
      for (size_t n = j; n < points; n += 2 * half) {
        double* upper = values + 2 * n;
        double* lower = values + 2 * (n + half);
        const Complex turned = w * Complex{lower[0], lower[1]};
        lower[0] = upper[0] - turned.re;
        lower[1] = upper[1] - turned.im;
        upper[0] += turned.re;
        upper[1] += turned.im;
      }
    }
  }
}

}  // namespace

bool real_fft(double* values, size_t size) {
  if (!is_fft_size(size)) return false;
  const size_t points = size / 2;
  complex_fft(values, points);
  // Z_k = E_k + i O_k holds the transforms of the even and of the odd values; X_k = E_k + w^k O_k.
  const double sum = values[0] + values[1];
  values[1] = values[0] - values[1];
  values[0] = sum;
  Rotor twiddle({0.0, -kPi / static_cast<double>(points)}, 1);
  for (size_t k = 1; k <= points / 2; ++k, twiddle.advance()) {
    double* low = values + 2 * k;
    double* high = values + 2 * (points - k);
    const Complex even = 0.5 * Complex{low[0] + high[0], low[1] - high[1]};
    const Complex odd = 0.5 * Complex{low[1] + high[1], high[0] - low[0]};
    const Complex turned = twiddle.value() * odd;
    low[0] = even.re + turned.re;
    low[1] = even.im + turned.im;
    if (high == low) break;
    high[0] = even.re - turned.re;
    high[1] = turned.im - even.im;
  }
  return true;
}

void to_power(double* values, size_t size) {
  const double last = values[1] * values[1];
  values[0] *= values[0];
  for (size_t k = 1; k < size / 2; ++k) values[k] = math::square(values[2 * k]) + math::square(values[2 * k + 1]);
  values[size / 2] = last;
}

void apply_hann(double* values, size_t count) {
  Rotor turn({0.0, 2.0 * kPi / static_cast<double>(count)});
  for (size_t n = 0; n < count; ++n, turn.advance()) values[n] *= 0.5 - 0.5 * turn.value().re;
}

double interpolated_peak(const double* power, size_t size, size_t k) {
  const auto bin = static_cast<double>(k);
  if (k == 0 || k >= size / 2) return bin;
  if (!(power[k - 1] > 0.0 && power[k] > 0.0 && power[k + 1] > 0.0)) return bin;
  const double left = math::log(power[k - 1] / power[k]);
  const double right = math::log(power[k + 1] / power[k]);
  if (left > 0.0 || right > 0.0 || !(left + right < 0.0)) return bin;
  return bin + 0.5 * (left - right) / (left + right);
}

}  // namespace stillpoint
