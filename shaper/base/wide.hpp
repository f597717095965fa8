// SPDX-License-Identifier: Apache-2.0
// 128-bit two's complement, for the profile's own arithmetic. All operations are exact modulo 2^128, so sums whose
// intermediate values leave the range still end on the right value.
#pragma once

#include <stdint.h>

namespace stillpoint {

struct Wide {
  uint64_t low;
  uint64_t high;

  static constexpr Wide from_int(int64_t value) {
    return Wide{static_cast<uint64_t>(value), value < 0 ? ~UINT64_C(0) : UINT64_C(0)};
  }
};

// The tick's own addition, in line; the others take more than a call of them.
[[gnu::always_inline]] constexpr Wide& operator+=(Wide& a, const Wide& b) {
  const uint64_t low = a.low + b.low;
  a.high += b.high + (low < a.low ? 1U : 0U);
  a.low = low;
  return a;
}

[[gnu::noinline]] constexpr Wide operator+(const Wide& a, const Wide& b) {
  Wide sum = a;
  return sum += b;
}

[[gnu::noinline]] constexpr Wide operator-(const Wide& a, const Wide& b) {
  return Wide{a.low - b.low, a.high - b.high - (a.low < b.low ? 1U : 0U)};
}

constexpr Wide operator-(const Wide& a) { return Wide{0, 0} - a; }

constexpr bool operator==(Wide a, Wide b) { return a.low == b.low && a.high == b.high; }
constexpr bool operator!=(Wide a, Wide b) { return !(a == b); }

constexpr bool is_negative(Wide a) { return (a.high >> 63) != 0; }

// 64 x 64 -> 128 bits, unsigned.
constexpr Wide multiply(uint64_t a, uint64_t b) {
  constexpr uint64_t kMask = 0xFFFFFFFFU;
  const uint64_t low = (a & kMask) * (b & kMask);
  const uint64_t middle_1 = (a >> 32) * (b & kMask) + (low >> 32);
  const uint64_t middle_2 = (a & kMask) * (b >> 32) + (middle_1 & kMask);
  return Wide{(low & kMask) | (middle_2 << 32), (a >> 32) * (b >> 32) + (middle_1 >> 32) + (middle_2 >> 32)};
}

// Modulo 2^128, so it serves signed and unsigned alike.
constexpr Wide operator*(Wide a, Wide b) {
  Wide product = multiply(a.low, b.low);
  product.high += a.low * b.high + a.high * b.low;
  return product;
}

// sum += a * b, modulo 2^128. Out of line: the product takes 100 bytes of code wherever it is inlined.
void add_product(Wide& sum, const Wide& a, const Wide& b);

// 0 <= bits < 128
constexpr Wide shifted_left(Wide a, int bits) {
  if (bits == 0) return a;
  if (bits >= 64) return Wide{0, a.low << (bits - 64)};
  return Wide{a.low << bits, (a.high << bits) | (a.low >> (64 - bits))};
}

// 0 <= bits < 64, towards minus infinity
constexpr Wide shifted_right(Wide a, int bits) {
  if (bits == 0) return a;
  const uint64_t sign = is_negative(a) ? ~UINT64_C(0) : 0;
  return Wide{(a.low >> bits) | (a.high << (64 - bits)), (a.high >> bits) | (sign << (64 - bits))};
}

// a * fraction * 2^-64, towards minus infinity
Wide times_fraction(const Wide& a, uint64_t fraction);

// a * b * 2^-64, towards minus infinity, both signed: the product of numbers with m and n fraction bits has m + n - 64.
Wide fixed_product(const Wide& a, const Wide& b);

// value * 2^fraction_bits to the nearest, halves away from zero. |value| * 2^fraction_bits < 2^127.
Wide wide_from_double(double value, int fraction_bits);

// The double nearest to a * 2^-fraction_bits, within 1 ulp.
double to_double(const Wide& a, int fraction_bits);

}  // namespace stillpoint
