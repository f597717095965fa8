// SPDX-License-Identifier: Apache-2.0
// The bottom of math.hpp: constants, and what is done on the bits of a double rather than with its arithmetic (on a
// chip without a double-precision unit that is also the cheaper way). IEEE 754 binary64 throughout.
//
// Everything here is pure, constexpr, callable from tick and background, and exact. No function returns the NaN it was
// given: its sign and payload differ between machines, so the answer is always kNan. What is long is kept out of line:
// inlined it would be a few hundred bytes in every file.
#pragma once

#include <float.h>
#include <limits.h>
#include <stddef.h>
#include <stdint.h>

namespace stillpoint::math {

static_assert(DBL_MANT_DIG == 53 && DBL_MAX_EXP == 1024 && sizeof(double) == sizeof(uint64_t));
static_assert(FLT_EVAL_METHOD == 0, "x87 arithmetic would round twice");

constexpr double kPi = 0x1.921fb54442d18p+1;

constexpr uint64_t bits_of(double value) { return __builtin_bit_cast(uint64_t, value); }
constexpr double from_bits(uint64_t bits) { return __builtin_bit_cast(double, bits); }

constexpr int kMantissaBits = 52;
constexpr int kExponentBias = 1023;
constexpr int kExponentOnes = 0x7FF;  // the exponent field of infinities and NaNs
constexpr uint64_t kSignMask = UINT64_C(1) << 63;
constexpr uint64_t kMantissaMask = (UINT64_C(1) << kMantissaBits) - 1U;

constexpr double kInfinity = from_bits(UINT64_C(0x7FF0000000000000));
constexpr double kNan = from_bits(UINT64_C(0x7FF8000000000000));

constexpr int exponent_field(double value) { return static_cast<int>(bits_of(value) >> kMantissaBits) & kExponentOnes; }

// 2^exponent, for exponents of normal numbers: [-1022, 1023].
constexpr double power_of_two(int exponent) {
  return from_bits(static_cast<uint64_t>(exponent + kExponentBias) << kMantissaBits);
}

constexpr bool is_finite(double value) { return exponent_field(value) != kExponentOnes; }
constexpr bool is_nan(double value) { return value != value; }
constexpr double abs(double value) { return is_nan(value) ? kNan : from_bits(bits_of(value) & ~kSignMask); }
// Of what is not a NaN, or is only compared: one instruction.
constexpr double magnitude(double value) { return __builtin_fabs(value); }
// Of two; the second where either is a NaN.
[[gnu::noinline]] constexpr double greater(double a, double b) { return a > b ? a : b; }
[[gnu::noinline]] constexpr double lesser(double a, double b) { return a < b ? a : b; }
constexpr double square(double value) { return value * value; }

// The sign of `sign` (also that of a zero) on the magnitude of `magnitude`, which is not a NaN.
constexpr double copysign(double magnitude, double sign) {
  return from_bits((bits_of(magnitude) & ~kSignMask) | (bits_of(sign) & kSignMask));
}

// Towards zero. Keeps the sign of a zero; an infinity stays.
[[gnu::noinline]] constexpr double trunc(double value) {
  if (is_nan(value)) return kNan;
  const int exponent = exponent_field(value) - kExponentBias;
  if (exponent >= kMantissaBits) return value;
  if (exponent < 0) return copysign(0.0, value);
  return from_bits(bits_of(value) & ~(kMantissaMask >> exponent));
}

[[gnu::noinline]] constexpr double floor(double value) {
  const double whole = trunc(value);
  return whole > value ? whole - 1.0 : whole;
}

[[gnu::noinline]] constexpr double ceil(double value) {
  const double whole = trunc(value);
  return whole < value ? whole + 1.0 : whole;
}

// The nearest integer, halves away from zero. |value| < 2^31 - 1.
[[gnu::noinline]] constexpr int32_t nearest_integer(double value) {
  return static_cast<int32_t>(value < 0.0 ? value - 0.5 : value + 0.5);
}

// value * 2^exponent, rounded once (that is: exact, unless the result is subnormal); overflows to an infinity,
// underflows to a zero of the same sign. Any exponent. Integer work and at most two multiplications by a power of two.
[[gnu::noinline]] constexpr double ldexp(double value, int exponent) {
  constexpr int kLift = 54;  // makes any subnormal number normal
  constexpr int kReach = DBL_MAX_EXP - DBL_MIN_EXP + 2 * kLift;
  if (is_nan(value)) return kNan;
  if (value == 0.0 || !is_finite(value)) return value;
  int field = exponent_field(value);
  if (field == 0) {
    value *= power_of_two(kLift);
    field = exponent_field(value) - kLift;
  }
  field += exponent > kReach ? kReach : exponent < -kReach ? -kReach : exponent;
  if (field >= kExponentOnes) return copysign(kInfinity, value);
  if (field <= -kLift) return copysign(0.0, value);
  const uint64_t rest = bits_of(value) & (kSignMask | kMantissaMask);
  if (field > 0) return from_bits(rest | static_cast<uint64_t>(field) << kMantissaBits);
  return from_bits(rest | static_cast<uint64_t>(field + kLift) << kMantissaBits) * power_of_two(-kLift);
}

// A positive finite number as mantissa * 2^exponent, mantissa in [1, 2).
struct Binary {
  uint64_t fraction;  // mantissa * 2^52, leading one included
  int exponent;
};

[[gnu::noinline]] constexpr Binary binary_of(double value) {
  constexpr int kLift = 54;
  const bool subnormal = exponent_field(value) == 0;
  if (subnormal) value *= power_of_two(kLift);
  return Binary{(bits_of(value) & kMantissaMask) | (kMantissaMask + 1U),
                exponent_field(value) - kExponentBias - (subnormal ? kLift : 0)};
}

// c[0] + c[1] z + ... + c[count - 1] z^(count - 1), Horner.
[[gnu::noinline]] constexpr double horner(const double* c, size_t count, double z) {
  double sum = c[count - 1];
  for (size_t i = count - 1; i-- > 0;) sum = sum * z + c[i];
  return sum;
}

template <size_t kCount>
constexpr double polynomial(const double (&c)[kCount], double z) {
  return horner(c, kCount, z);
}

}  // namespace stillpoint::math
