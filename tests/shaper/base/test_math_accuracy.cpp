// SPDX-License-Identifier: Apache-2.0
// The module's own mathematics against long double libm.
#include <cmath>
#include <initializer_list>

#include "shaper/base/math.hpp"
#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

namespace {

namespace math = stillpoint::math;
using stillpoint::testing::Random;

constexpr double kSmallest = 0x1p-1074;

#define TEST_ASSERT_SAME_BITS(expected, actual) TEST_ASSERT_EQUAL_UINT64(math::bits_of(expected), math::bits_of(actual))

// Any sign, any exponent, subnormal numbers, infinities and NaNs now and then.
double any_double(Random& random) { return math::from_bits(random.next()); }

// Zero to `largest` in size, small ones as likely as large ones, either sign.
double any_size(Random& random, double largest) {
  const double value = random.between(-largest, largest);
  return math::ldexp(value, -static_cast<int>(random.integer(0, 40)));
}

// The oracle must be finer than what it judges (it is where long double is the x87's).
static_assert(LDBL_MANT_DIG >= 64);

long double widened(double value) { return static_cast<long double>(value); }

double error_ulp(double actual, long double expected) {
  int exponent = 0;
  std::frexp(expected, &exponent);
  if (exponent < DBL_MIN_EXP) exponent = DBL_MIN_EXP;
  return static_cast<double>(std::fabs(widened(actual) - expected) / std::ldexp(1.0L, exponent - DBL_MANT_DIG));
}

struct Worst {
  double ulp = 0.0;
  double argument = 0.0;
  double second_argument = 0.0;

  void see(double error, double x, double second = 0.0) {
    if (error <= ulp) return;  // a NaN is kept, and fails
    *this = Worst{error, x, second};
  }
};

#define TEST_ASSERT_WORST_AT_MOST(limit_ulp, worst)      \
  do {                                                   \
    TEST_INFO(argument, (worst).argument);               \
    TEST_INFO(second_argument, (worst).second_argument); \
    TEST_ASSERT_AT_MOST_DOUBLE(limit_ulp, (worst).ulp);  \
  } while (false)

constexpr int kSweep = 200000;

double any_positive_finite(Random& random) {
  const double value = math::abs(any_double(random));
  return math::is_finite(value) ? value : 1.0;
}

TEST_HOST(square_root_is_correctly_rounded) {
  Random random(1);
  for (int i = 0; i < kSweep; ++i) {
    const double x = i % 2 == 0 ? any_positive_finite(random) : random.between(1.0, 4.0);
    const double subnormal = math::from_bits(random.next() & math::kMantissaMask);
    // next to a square, where the root is next to a tie
    const double square_of = math::square(1.0 + static_cast<double>(random.integer(0, 1 << 26)) * 0x1p-26);
    const double beside = math::from_bits(math::bits_of(square_of) + static_cast<uint64_t>(random.integer(-2, 2)));
    for (const double argument : {x, subnormal, beside}) {
      TEST_INFO(argument, argument);
      if (argument > 0.0) TEST_ASSERT_SAME_BITS(std::sqrt(argument), math::sqrt_in_integers(argument));
      TEST_ASSERT_SAME_BITS(std::sqrt(argument), math::sqrt(argument));
    }
  }
}

TEST_HOST(cube_root_agrees_with_libm) {
  Random random(2);
  Worst worst;
  for (int i = 0; i < kSweep; ++i) {
    const double normal = i % 2 == 0 ? any_positive_finite(random) : random.between(1.0, 8.0);
    const double subnormal = math::from_bits(random.next() & math::kMantissaMask);
    for (const double x : {normal, -normal, subnormal}) worst.see(error_ulp(math::cbrt(x), std::cbrt(widened(x))), x);
  }
  TEST_ASSERT_WORST_AT_MOST(0.53, worst);
}

TEST_HOST(exponential_agrees_with_libm) {
  Random random(3);
  Worst worst;
  const double half_ln2 = 0.5 * math::kLn2Head;
  for (int i = 0; i < kSweep; ++i) {
    const double wide = random.between(-708.0, 709.7);
    const double narrow = random.between(-2.0, 2.0);
    // where the reduction changes from one multiple of ln 2 to the next
    const double seam =
        static_cast<double>(2 * random.integer(-1000, 1000) + 1) * half_ln2 * random.between(0.999, 1.001);
    for (const double x : {wide, narrow, seam, math::ldexp(narrow, -(i % 60))}) {
      worst.see(error_ulp(math::exp(x), std::exp(widened(x))), x);
    }
  }
  TEST_ASSERT_WORST_AT_MOST(0.75, worst);

  Worst subnormal;  // a last place there is 2^-1074, and the result is rounded twice
  for (int i = 0; i < kSweep; ++i) {
    const double x = random.between(-745.0, -708.0);
    subnormal.see(error_ulp(math::exp(x), std::exp(widened(x))), x);
  }
  TEST_ASSERT_WORST_AT_MOST(1.2, subnormal);
}

TEST_HOST(logarithm_agrees_with_libm) {
  Random random(4);
  Worst worst;
  for (int i = 0; i < kSweep; ++i) {
    const double wide = any_positive_finite(random);
    const double narrow = random.between(0.25, 4.0);
    const double near_one = 1.0 + math::ldexp(random.between(-0.5, 0.5), -(i % 52));
    const double subnormal = math::from_bits((random.next() & math::kMantissaMask) | 1U);
    for (const double x : {wide, narrow, near_one, subnormal})
      worst.see(error_ulp(math::log(x), std::log(widened(x))), x);
  }
  TEST_ASSERT_WORST_AT_MOST(0.9, worst);
}

// The doubles next to a random multiple of pi/2.
double near_quarter_turn(Random& random) {
  constexpr long double kHalfPi = 1.57079632679489661923132169163975144L;
  const double x = static_cast<double>(static_cast<long double>(random.integer(1, 1000000)) * kHalfPi);
  const double beside = math::from_bits(math::bits_of(x) + static_cast<uint64_t>(random.integer(-3, 3)));
  return random.integer(0, 1) == 0 ? beside : -beside;
}

TEST_HOST(sine_and_cosine_agree_with_libm) {
  Random random(5);
  Worst sine;
  Worst cosine;
  const auto see = [&](double x) {
    sine.see(error_ulp(math::sin(x), std::sin(widened(x))), x);
    cosine.see(error_ulp(math::cos(x), std::cos(widened(x))), x);
  };
  for (int i = 0; i < kSweep; ++i) {
    see(random.between(-math::kLargestAngle, math::kLargestAngle));
    see(random.between(-7.0, 7.0));
    see(math::ldexp(random.between(-1.0, 1.0), -(i % 60)));
    see(near_quarter_turn(random));
    see(static_cast<double>(random.integer(-100000, 100000)) * (math::kPi / 4.0));  // where the quadrant changes
  }
  see(0x1.6c6cbc45dc8dep+5);  // 2^-60.5 beside 29 pi/2: no double below kLargestAngle is nearer to a multiple
  TEST_ASSERT_WORST_AT_MOST(0.85, sine);
  TEST_ASSERT_WORST_AT_MOST(0.85, cosine);
}

TEST_HOST(arc_tangent_agrees_with_libm) {
  Random random(6);
  Worst worst;
  const auto see = [&](double y, double x) {
    worst.see(error_ulp(math::atan2(y, x), std::atan2(widened(y), widened(x))), y, x);
  };
  for (int i = 0; i < kSweep; ++i) {
    see(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    const double x = any_double(random);
    const double y = any_double(random);
    if (math::is_finite(x) && math::is_finite(y)) see(y, x);
    // the same size as x, at every exponent, subnormal ones too
    const double alike = x * random.between(-4.0, 4.0);
    if (math::is_finite(alike)) see(alike, x), see(x, alike);
    // 0.3125 and 0.75, where the reduction changes, and a quarter, where the result falls a binade below the quotient
    const double width = random.between(1.0, 2.0);
    for (const double ratio : {0.25, 0.3125, 0.75}) see(width * ratio * random.between(0.97, 1.03), width);
    // two subnormal numbers
    see(static_cast<double>(random.integer(-50, 50)) * kSmallest,
        static_cast<double>(random.integer(1, 50)) * kSmallest);
  }
  TEST_ASSERT_WORST_AT_MOST(1.6, worst);
}

TEST_HOST(exact_helpers_agree_with_libm) {
  Random random(7);
  for (int i = 0; i < kSweep; ++i) {
    const double any = any_positive_finite(random) * (i % 2 == 0 ? 1.0 : -1.0);
    for (const double x : {any, any_size(random, 0x1p+54)}) {
      TEST_INFO(argument, x);
      TEST_ASSERT_SAME_BITS(std::floor(x), math::floor(x));
      TEST_ASSERT_SAME_BITS(std::ceil(x), math::ceil(x));
      const int exponent = static_cast<int>(random.integer(-2200, 2200));
      TEST_INFO(exponent, exponent);
      TEST_ASSERT_SAME_BITS(std::ldexp(x, exponent), math::ldexp(x, exponent));
      TEST_ASSERT_SAME_BITS(std::ldexp(x, exponent / 16), math::ldexp(x, exponent / 16));
    }
  }
}

}  // namespace
