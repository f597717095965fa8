// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/math.hpp"

#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

namespace {

namespace math = stillpoint::math;
using stillpoint::testing::Random;

constexpr double kLargest = DBL_MAX;
constexpr double kSmallestNormal = DBL_MIN;
constexpr double kSmallest = 0x1p-1074;

#define TEST_ASSERT_SAME_BITS(expected, actual) TEST_ASSERT_EQUAL_UINT64(math::bits_of(expected), math::bits_of(actual))

// ---- closed form, at compile time and at run time

static_assert(math::sqrt(2.0) == 0x1.6a09e667f3bcdp+0);
static_assert(math::cbrt(-27.0) == -3.0);
static_assert(math::exp(1.0) == 0x1.5bf0a8b145769p+1);
static_assert(math::log(10.0) == 0x1.26bb1bbb55516p+1);
static_assert(math::sin(1.0) == 0x1.aed548f090ceep-1);
static_assert(math::cos(1.0) == 0x1.14a280fb5068cp-1);
static_assert(math::atan2(1.0, 1.0) == math::kPi / 4.0);
static_assert(math::floor(-0.5) == -1.0 && math::ceil(0.5) == 1.0);
static_assert(math::ldexp(0.75, 2) == 3.0);

// Keeps the compiler from doing the run-time twin's work itself.
double opaque(double value) {
  volatile double hidden = value;
  return hidden;
}

TEST(run_time_gives_what_compile_time_gave) {
  TEST_ASSERT_SAME_BITS(0x1.6a09e667f3bcdp+0, math::sqrt(opaque(2.0)));
  TEST_ASSERT_SAME_BITS(-3.0, math::cbrt(opaque(-27.0)));
  TEST_ASSERT_SAME_BITS(0x1.5bf0a8b145769p+1, math::exp(opaque(1.0)));
  TEST_ASSERT_SAME_BITS(0x1.26bb1bbb55516p+1, math::log(opaque(10.0)));
  TEST_ASSERT_SAME_BITS(0x1.aed548f090ceep-1, math::sin(opaque(1.0)));
  TEST_ASSERT_SAME_BITS(0x1.14a280fb5068cp-1, math::cos(opaque(1.0)));
  TEST_ASSERT_SAME_BITS(math::kPi / 4.0, math::atan2(opaque(1.0), opaque(1.0)));
  TEST_ASSERT_SAME_BITS(-1.0, math::floor(opaque(-0.5)));
  TEST_ASSERT_SAME_BITS(3.0, math::ldexp(opaque(0.75), 2));
}

TEST(roots_of_whole_squares_and_cubes_are_exact) {
  for (int32_t i = 0; i <= 1000; ++i) {
    TEST_INFO(root, i);
    const double root = i;
    TEST_ASSERT_SAME_BITS(root, math::sqrt(root * root));
    TEST_ASSERT_SAME_BITS(root, math::cbrt(root * root * root));
    TEST_ASSERT_SAME_BITS(-root, math::cbrt(-root * root * root));
  }
}

TEST(square_root_at_the_ends_of_its_domain) {
  TEST_ASSERT_SAME_BITS(-0.0, math::sqrt(-0.0));
  TEST_ASSERT_SAME_BITS(0x1p-537, math::sqrt(kSmallest));
  TEST_ASSERT_SAME_BITS(0x1p-511, math::sqrt(kSmallestNormal));
  TEST_ASSERT_SAME_BITS(0x1.fffffffffffffp+511, math::sqrt(kLargest));
  TEST_ASSERT_SAME_BITS(0x1.fffffffffffffp-1, math::sqrt(0x1.fffffffffffffp-1));
  TEST_ASSERT_SAME_BITS(math::kInfinity, math::sqrt(math::kInfinity));
  TEST_ASSERT_SAME_BITS(math::kNan, math::sqrt(-kSmallest));
  TEST_ASSERT_SAME_BITS(math::kNan, math::sqrt(math::kNan));
}

TEST(exponential_and_logarithm_at_the_ends_of_their_domains) {
  TEST_ASSERT_SAME_BITS(1.0, math::exp(0.0));
  TEST_ASSERT_SAME_BITS(1.0, math::exp(-kSmallest));
  TEST_ASSERT_TRUE(math::is_finite(math::exp(709.78)));
  TEST_ASSERT_SAME_BITS(math::kInfinity, math::exp(709.79));
  TEST_ASSERT_SAME_BITS(math::kInfinity, math::exp(kLargest));
  TEST_ASSERT_SAME_BITS(kSmallest, math::exp(-745.13));
  TEST_ASSERT_SAME_BITS(0.0, math::exp(-745.14));
  TEST_ASSERT_SAME_BITS(0.0, math::exp(-math::kInfinity));
  TEST_ASSERT_SAME_BITS(math::kNan, math::exp(-math::kNan));

  TEST_ASSERT_SAME_BITS(0.0, math::log(1.0));
  TEST_ASSERT_SAME_BITS(-math::kInfinity, math::log(0.0));
  TEST_ASSERT_SAME_BITS(-math::kInfinity, math::log(-0.0));
  TEST_ASSERT_SAME_BITS(math::kInfinity, math::log(math::kInfinity));
  TEST_ASSERT_SAME_BITS(math::kNan, math::log(-1.0));
  TEST_ASSERT_SAME_BITS(math::kNan, math::log(-math::kNan));
}

TEST(sine_and_cosine_at_the_ends_of_their_domains) {
  TEST_ASSERT_SAME_BITS(-0.0, math::sin(-0.0));
  TEST_ASSERT_SAME_BITS(1.0, math::cos(-0.0));
  TEST_ASSERT_SAME_BITS(kSmallest, math::sin(kSmallest));
  TEST_ASSERT_SAME_BITS(0x1.1a62633145c07p-53, math::sin(math::kPi));
  TEST_ASSERT_SAME_BITS(-1.0, math::cos(math::kPi));
  TEST_ASSERT_TRUE(math::is_finite(math::sin(-math::kLargestAngle)));
  TEST_ASSERT_SAME_BITS(math::kNan, math::sin(1.7e6));
  TEST_ASSERT_SAME_BITS(math::kNan, math::cos(-math::kInfinity));
  TEST_ASSERT_SAME_BITS(math::kNan, math::cos(-math::kNan));
}

TEST(arc_tangent_on_the_axes_and_diagonals) {
  constexpr double kPi = math::kPi;
  constexpr double kInf = math::kInfinity;
  struct Point {
    double y, x, angle;
  };
  const Point points[] = {{0.0, 0.0, 0.0},
                          {0.0, 1.0, 0.0},
                          {0.0, -0.0, kPi},
                          {0.0, -1.0, kPi},
                          {1.0, 0.0, kPi / 2.0},
                          {1.0, -0.0, kPi / 2.0},
                          {1.0, 1.0, kPi / 4},
                          {1.0, -1.0, 0.75 * kPi},
                          {1.0, kInf, 0.0},
                          {1.0, -kInf, kPi},
                          {kInf, 1.0, kPi / 2},
                          {kInf, -1.0, kPi / 2},
                          {kInf, kInf, kPi / 4},
                          {kInf, -kInf, 0.75 * kPi},
                          {kSmallest, kLargest, 0.0},
                          {kLargest, kSmallest, kPi / 2},
                          {kLargest, kLargest, kPi / 4},
                          {kSmallest, -kSmallest, 0.75 * kPi}};
  for (const Point& point : points) {
    TEST_INFO(y, point.y);
    TEST_INFO(x, point.x);
    TEST_ASSERT_SAME_BITS(point.angle, math::atan2(point.y, point.x));
    TEST_ASSERT_SAME_BITS(-point.angle, math::atan2(-point.y, point.x));
  }
  TEST_ASSERT_SAME_BITS(math::kNan, math::atan2(-math::kNan, 1.0));
  TEST_ASSERT_SAME_BITS(math::kNan, math::atan2(1.0, -math::kNan));
}

TEST(rounding_to_whole_numbers_keeps_large_values_and_signs) {
  TEST_ASSERT_SAME_BITS(-0.0, math::floor(-0.0));
  TEST_ASSERT_SAME_BITS(-0.0, math::ceil(-0.5));
  TEST_ASSERT_SAME_BITS(-1.0, math::floor(-kSmallest));
  TEST_ASSERT_SAME_BITS(1.0, math::ceil(kSmallest));
  TEST_ASSERT_SAME_BITS(-3.0, math::floor(-2.5));
  TEST_ASSERT_SAME_BITS(-2.0, math::ceil(-2.5));
  TEST_ASSERT_SAME_BITS(0x1.fffffffffffffp+51, math::floor(0x1.fffffffffffffp+51) + 0.5);
  TEST_ASSERT_SAME_BITS(0x1p+52, math::ceil(0x1.fffffffffffffp+51));
  TEST_ASSERT_SAME_BITS(kLargest, math::floor(kLargest));
  TEST_ASSERT_SAME_BITS(-math::kInfinity, math::ceil(-math::kInfinity));
  TEST_ASSERT_SAME_BITS(math::kNan, math::floor(-math::kNan));
}

TEST(scaling_by_a_power_of_two_rounds_once) {
  TEST_ASSERT_SAME_BITS(kSmallest, math::ldexp(1.0, -1074));
  TEST_ASSERT_SAME_BITS(1.0, math::ldexp(kSmallest, 1074));
  TEST_ASSERT_SAME_BITS(0.0, math::ldexp(1.0, -1075));  // a tie, to even
  TEST_ASSERT_SAME_BITS(kSmallest, math::ldexp(0x1.0000000000001p+0, -1075));
  TEST_ASSERT_SAME_BITS(-0.0, math::ldexp(-1.0, -1076));
  TEST_ASSERT_SAME_BITS(-0.0, math::ldexp(-kLargest, INT_MIN));
  TEST_ASSERT_SAME_BITS(math::kInfinity, math::ldexp(kSmallest, INT_MAX));
  TEST_ASSERT_SAME_BITS(math::kInfinity, math::ldexp(1.0, 1024));
  TEST_ASSERT_SAME_BITS(-0.0, math::ldexp(-0.0, 5));
}

TEST(what_is_finite) {
  TEST_ASSERT_TRUE(math::is_finite(kLargest) && math::is_finite(-0.0) && math::is_finite(kSmallest));
  TEST_ASSERT_FALSE(math::is_finite(math::kInfinity) || math::is_finite(-math::kInfinity) ||
                    math::is_finite(math::kNan));
  TEST_ASSERT_SAME_BITS(0.0, math::abs(-0.0));
  TEST_ASSERT_SAME_BITS(math::kInfinity, math::abs(-math::kInfinity));
}

// ---- the same bits on every machine

// FNV-1a over the result bits of `count` evaluations.
template <typename Evaluate>
uint64_t hash_of(Evaluate evaluate) {
  constexpr int kEvaluations = 400;
  Random random(20);
  uint64_t hash = UINT64_C(0xCBF29CE484222325);
  for (int i = 0; i < kEvaluations; ++i) {
    const uint64_t bits = math::bits_of(evaluate(random));
    for (unsigned shift = 0; shift < 64; shift += 8) {
      hash = (hash ^ ((bits >> shift) & 0xFFU)) * UINT64_C(0x100000001B3);
    }
  }
  return hash;
}

// Any sign, any exponent, subnormal numbers, infinities and NaNs now and then.
double any_double(Random& random) { return math::from_bits(random.next()); }

// Zero to `largest` in size, small ones as likely as large ones, either sign.
double any_size(Random& random, double largest) {
  const double value = random.between(-largest, largest);
  return math::ldexp(value, -static_cast<int>(random.integer(0, 40)));
}

TEST(square_root_has_the_same_bits_everywhere) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0xB3231B6BACE76D41),
                           hash_of([](Random& random) { return math::sqrt(math::abs(any_double(random))); }));
}

TEST(cube_root_has_the_same_bits_everywhere) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0xA6AF035B6E112459),
                           hash_of([](Random& random) { return math::cbrt(any_double(random)); }));
}

TEST(exponential_has_the_same_bits_everywhere) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0xAD7EE08B92FCEB32),
                           hash_of([](Random& random) { return math::exp(any_size(random, 750.0)); }));
}

TEST(logarithm_has_the_same_bits_everywhere) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x3445F065C90F8CF2), hash_of([](Random& random) {
                             const bool near_one = random.integer(0, 1) == 0;
                             return math::log(near_one ? random.between(0.5, 2.0) : math::abs(any_double(random)));
                           }));
}

TEST(sine_has_the_same_bits_everywhere) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x47E042EA36F6A6AC),
                           hash_of([](Random& random) { return math::sin(any_size(random, 1.6e6)); }));
}

TEST(cosine_has_the_same_bits_everywhere) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x42DF1223C35916D2),
                           hash_of([](Random& random) { return math::cos(any_size(random, 1.6e6)); }));
}

TEST(arc_tangent_has_the_same_bits_everywhere) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x144A3E08FF66690F), hash_of([](Random& random) {
                             const bool alike = random.integer(0, 1) == 0;
                             const double y = alike ? random.between(-1.0, 1.0) : any_double(random);
                             const double x = alike ? random.between(-1.0, 1.0) : any_double(random);
                             return math::atan2(y, x);
                           }));
}

}  // namespace
