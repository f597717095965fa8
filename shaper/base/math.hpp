// SPDX-License-Identifier: Apache-2.0
// Mathematics without a C library: square and cube root, exponential, logarithm here; sine, cosine and arc tangent in
// math_trigonometry.hpp; exact helpers in math_bits.hpp. Include this file for all of it.
//
// The same bits everywhere: only IEEE addition, subtraction, multiplication, division and integer work, in one written
// order, to be compiled with -ffp-contract=off. A fused multiply-add anywhere would break that.
//
// Everything is pure and constexpr. For the background: on an emulated Cortex-M4 at -Os, sqrt takes 1000 instructions
// and every other function here 2300 to 2800; on a Cortex-M0, 1600 and 6600 to 8100 (November 2026). "Cost" counts
// double-precision operations as multiplications + additions + divisions. "Error" is the worst seen against long double
// libm in 2*10^7 arguments, in units in the last place of the result; tests/shaper/base/test_math.cpp holds a bound
// just above it. Outside its domain a function answers kNan, as it does to a NaN.
//
// The polynomials are minimax, from a Remez exchange in 300-bit arithmetic, each rounded coefficient held fixed while
// the rest were fitted again (kExp: all rounded at the end); "within 2^-n" is what is left against the function
// approximated. Methods: Muller, Elementary Functions, 3rd ed. (range reduction chapter 11, polynomials chapter 3);
// Muller et al., Handbook of Floating-Point Arithmetic, 2nd ed. (exact products and sums, chapter 4).
#pragma once

#include "shaper/base/math_bits.hpp"
#include "shaper/base/math_trigonometry.hpp"

namespace stillpoint::math {

// Square root, correctly rounded, for every x > 0.
// Cost: 53 rounds of 64-bit integer add, compare and shift: on a Cortex-M4 less than two divisions in soft double.
// Method: the pencil-and-paper root, bit by bit (Ercegovac and Lang, Digital Arithmetic, chapter 6).
constexpr double sqrt_in_integers(double x) {
  const Binary binary = binary_of(x);
  const int odd = binary.exponent & 1;
  constexpr uint64_t kOne = UINT64_C(1) << (kMantissaBits + 2);
  // x = 2^(exponent - odd) * (root^2 + remainder / 2^round) with root, remainder in units of 1 / kOne
  uint64_t root = kOne;
  uint64_t remainder = (binary.fraction << (2 + odd)) - kOne;
  for (uint64_t bit = kOne >> 2; bit != 0; bit >>= 1) {
    const uint64_t trial = root + bit;
    if (remainder >= trial) {
      remainder -= trial;
      root += 2 * bit;
    }
    remainder <<= 1;
  }
  // Two bits below the last place: the upper decides (the root of a double is never half-way), the lower is zero.
  const uint64_t rounded = (root + 2) >> 2;
  return from_bits(rounded + (static_cast<uint64_t>((binary.exponent - odd) / 2 + kExponentBias - 1) << kMantissaBits));
}

// sqrt() as a chip runs it: out of line, as the other long ones.
double sqrt_out_of_line(double x);

// The same for every x >= 0; the sign of a zero stays. At run time on an x86-64 by its instruction, whose result is
// correctly rounded too: the same bits in a tenth of the time.
constexpr double sqrt(double x) {
#if !defined(__SSE2_MATH__)
  if (!__builtin_is_constant_evaluated()) return sqrt_out_of_line(x);
#endif
  if (x == 0.0 || x == kInfinity) return x;
  if (!(x > 0.0)) return kNan;
#if defined(__SSE2_MATH__)
  if (!__builtin_is_constant_evaluated()) return __builtin_sqrt(x);
#endif
  return sqrt_in_integers(x);
}

// Within 2^-9.1 of the reciprocal cube root on [1, 2], and that of 1, 2, 4.
inline constexpr double kReciprocalCbrt[] = {0x1.635e4071becbfp+0, -0x1.eeebeabe7cab7p-2, 0x1.7e8e63a47a74fp-4};
inline constexpr double kReciprocalCbrtOfPower[] = {1.0, 0x1.965fea53d6e3dp-1, 0x1.428a2f98d728bp-1};

// Cube root, any finite x, odd. Error 0.52 ulp. Cost 18 + 12 + 1.
// Method: y -> a^(-1/3) from a parabola by one step of order four, no division; then t ~ a y^2 shortened to 26 bits, so
// that a - t^3 comes out almost exactly, and one step to the root from there: a - t^3 = (root - t)(root^2 + root t +
// t^2).
[[gnu::noinline]] constexpr double cbrt(double x) {
  if (is_nan(x)) return kNan;
  if (x == 0.0 || !is_finite(x)) return x;
  const Binary binary = binary_of(magnitude(x));
  const int third = (binary.exponent + 3 * kExponentBias) / 3 - kExponentBias;
  const int power = binary.exponent - 3 * third;
  const double m = from_bits(binary.fraction + (static_cast<uint64_t>(kExponentBias - 1) << kMantissaBits));
  const double a = m * power_of_two(power);

  const double seed = polynomial(kReciprocalCbrt, m) * kReciprocalCbrtOfPower[power];
  const double e = 1.0 - a * (seed * seed * seed);
  const double y = seed + seed * (e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0))));
  const double near_root = a * (y * y);

  constexpr uint64_t kLow27 = (UINT64_C(1) << 27) - 1U;
  const double t = from_bits((bits_of(near_root) + (kLow27 >> 1)) & ~kLow27);
  const double tt = t * t;
  const double tt_head = from_bits(bits_of(tt) & ~kLow27);
  const double left = (a - tt_head * t) - (tt - tt_head) * t;
  const double root = t + left / (near_root * (near_root + t) + tt);
  return copysign(root * power_of_two(third), x);
}

// ln 2 in two parts; the first has 38 bits, so that a multiple of it up to 2^15 is exact.
constexpr double kLn2Head = 0x1.62e42fefap-1;
constexpr double kLn2Tail = 0x1.cf79abc9e3b3ap-40;

// (e^r - 1 - r - r^2/2) / r^3 on |r| <= ln(2)/2, within 2^-57 of e^r.
inline constexpr double kExp[] = {0x1.5555555555521p-3,  0x1.55555555533cp-5,   0x1.1111111122e7cp-7,
                                  0x1.6c16c17c49b5bp-10, 0x1.a01a0132e98cfp-13, 0x1.a019ac81b28b6p-16,
                                  0x1.71df2e09a2c78p-19, 0x1.289e57fac47a3p-22, 0x1.ad50f3987e0f7p-26};

// e^x. Error 0.71 ulp on [-708, 709]; below, where results are subnormal, their last place; infinity above 709.78,
// zero below -745.13. Cost 14 + 18 + 0.
// Method: x = k ln 2 + r; polynomial in r; 1 + r summed with its rounding error kept.
[[gnu::noinline]] constexpr double exp(double x) {
  if (is_nan(x)) return kNan;
  if (x > 709.8) return kInfinity;
  if (x < -745.2) return 0.0;
  const int32_t k = nearest_integer(x * 0x1.71547652b82fep+0);
  const double head = x - k * kLn2Head;  // exact
  const double tail = k * kLn2Tail;
  const double r = head - tail;
  const double curve = r * r * (0.5 + r * polynomial(kExp, r));
  const double sum = 1.0 + head;
  const double lost = (1.0 - sum) + head;
  return ldexp(sum + (lost + (curve - tail)), static_cast<int>(k));
}

// (ln((1 + s) / (1 - s)) / s - 2) / s^2 in s^2, for (1 + s) / (1 - s) in [sqrt(1/2), sqrt(2)], within 2^-59 of ln.
inline constexpr double kLog[] = {0x1.555555555557fp-1, 0x1.9999999984aa8p-2, 0x1.2492493e78b6ap-2,
                                  0x1.c71c5473b20eep-3, 0x1.7465cedf828b9p-3, 0x1.39abe99d9a5e7p-3,
                                  0x1.2ea774f3f9572p-3};

// Natural logarithm, x > 0, subnormal ones too; ln 0 is minus infinity. Error 0.84 ulp. Cost 13 + 13 + 1.
// Method: x = 2^k (1 + f); with s = f / (2 + f), ln(1 + f) = 2 s + s R(s^2) = f - (f^2/2 - s (f^2/2 + R)), whose
// leading term is exact.
[[gnu::noinline]] constexpr double log(double x) {
  if (x == 0.0) return -kInfinity;
  if (x == kInfinity) return kInfinity;
  if (!(x > 0.0)) return kNan;
  const Binary binary = binary_of(x);
  constexpr uint64_t kRootTwo = UINT64_C(0x16A09E667F3BCD);  // sqrt(2) * 2^52
  const bool halve = binary.fraction >= kRootTwo;
  const int k = binary.exponent + (halve ? 1 : 0);
  const uint64_t exponent_minus_one = static_cast<uint64_t>(kExponentBias - (halve ? 2 : 1));
  const double f = from_bits(binary.fraction + (exponent_minus_one << kMantissaBits)) - 1.0;

  const double s = f / (2.0 + f);
  const double z = s * s;
  const double half_square = 0.5 * f * f;
  const double small = s * (half_square + z * polynomial(kLog, z)) + k * kLn2Tail;
  return k * kLn2Head - ((half_square - small) - f);
}

}  // namespace stillpoint::math
