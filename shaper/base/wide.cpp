// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/wide.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

void add_product(Wide& sum, const Wide& a, const Wide& b) { sum += a * b; }

Wide times_fraction(const Wide& a, uint64_t fraction) {
  Wide product = multiply(a.high, fraction);
  if (is_negative(a)) product.high -= fraction;
  product += Wide{multiply(a.low, fraction).high, 0};
  return product;
}

Wide fixed_product(const Wide& a, const Wide& b) {
  Wide product = times_fraction(a, b.low);
  product += a * Wide::from_int(static_cast<int64_t>(b.high));
  return product;
}

Wide wide_from_double(double value, int fraction_bits) {
  const uint64_t bits = __builtin_bit_cast(uint64_t, value);
  const int exponent_field = static_cast<int>((bits >> 52) & 0x7FFU);
  if (exponent_field == 0) return Wide{0, 0};  // zero, and subnormals are far below any fraction here
  const uint64_t mantissa = (bits & ((UINT64_C(1) << 52) - 1U)) | (UINT64_C(1) << 52);
  const int shift = exponent_field - 1075 + fraction_bits;
  Wide magnitude{0, 0};
  if (shift >= 0) {
    magnitude = shifted_left(Wide{mantissa, 0}, shift < 127 ? shift : 127);
  } else if (shift >= -53) {
    magnitude.low = (mantissa + (UINT64_C(1) << (-shift - 1))) >> -shift;
  }
  return (bits >> 63) != 0 ? -magnitude : magnitude;
}

double to_double(const Wide& a, int fraction_bits) {
  const bool negative = is_negative(a);
  const Wide magnitude = negative ? -a : a;
  const double value = math::ldexp(static_cast<double>(magnitude.high), 64 - fraction_bits) +
                       math::ldexp(static_cast<double>(magnitude.low), -fraction_bits);
  return negative ? -value : value;
}

}  // namespace stillpoint
