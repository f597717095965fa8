// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/wide.hpp"

#include "shaper/base/signal.hpp"
#include "tests/support/test.hpp"

using stillpoint::counts_from_signal;
using stillpoint::fixed_product;
using stillpoint::kSignalPerCount;
using stillpoint::multiply;
using stillpoint::shifted_right;
using stillpoint::signal_from_counts;
using stillpoint::times_fraction;
using stillpoint::to_double;
using stillpoint::Wide;
using stillpoint::wide_from_double;
using stillpoint::testing::Random;

static_assert(Wide::from_int(-1) + Wide::from_int(1) == Wide{0, 0}, "");
static_assert(Wide::from_int(-3) * Wide::from_int(5) == Wide::from_int(-15), "");
static_assert(signal_from_counts(-2) == -2 * kSignalPerCount, "");

TEST(doubles_become_fixed_point_and_back_exactly_where_they_fit) {
  const double values[] = {0.0, 1.0, -1.0, 0.5, -2147483648.0, 2147483647.0, 1e-9, -3.25};
  for (unsigned i = 0; i < sizeof values / sizeof values[0]; ++i) {
    TEST_ASSERT_TRUE(to_double(wide_from_double(values[i], 96), 96) == values[i]);
  }
}

TEST(what_is_below_the_last_bit_is_rounded_to_the_nearest) {
  const double lsb = 1.0 / 4294967296.0;
  TEST_ASSERT_TRUE(wide_from_double(0.49 * lsb, 32) == Wide::from_int(0));
  TEST_ASSERT_TRUE(wide_from_double(0.51 * lsb, 32) == Wide::from_int(1));
  TEST_ASSERT_TRUE(wide_from_double(-0.51 * lsb, 32) == Wide::from_int(-1));
  TEST_ASSERT_TRUE(wide_from_double(1e-300, 32) == Wide::from_int(0));
}

TEST(signals_round_to_the_nearest_count_and_saturate_at_the_ends) {
  TEST_ASSERT_EQUAL_INT32(1, counts_from_signal(kSignalPerCount / 2));
  TEST_ASSERT_EQUAL_INT32(0, counts_from_signal(kSignalPerCount / 2 - 1));
  TEST_ASSERT_EQUAL_INT32(-1, counts_from_signal(-kSignalPerCount / 2 - 1));
  TEST_ASSERT_EQUAL_INT32(INT32_MAX, counts_from_signal(INT64_MAX));
  TEST_ASSERT_EQUAL_INT32(INT32_MIN, counts_from_signal(INT64_MIN));
}

#ifndef STILLPOINT_CHIP_TESTS

namespace {

__extension__ using Native = unsigned __int128;
__extension__ using SignedNative = __int128;

Native native(Wide a) { return (static_cast<Native>(a.high) << 64) | a.low; }

// Operands that reach the carries: full words, short ones, and runs of ones.
Wide any_wide(Random& random) {
  const auto word = [&random] {
    const uint64_t bits = random.next();
    return random.next() % 3 == 0 ? ~UINT64_C(0) << (bits % 64) : bits >> (bits % 64);
  };
  const uint64_t low = word();
  return Wide{low, word()};
}

}  // namespace

TEST_HOST(arithmetic_agrees_with_the_compilers_own_128_bits) {
  const uint64_t seed = 20261122;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 100000; ++i) {
    const Wide a = any_wide(random);
    const Wide b = any_wide(random);
    TEST_ASSERT_TRUE(native(a + b) == native(a) + native(b));
    TEST_ASSERT_TRUE(native(a - b) == native(a) - native(b));
    TEST_ASSERT_TRUE(native(a * b) == native(a) * native(b));
    TEST_ASSERT_TRUE(native(multiply(a.low, b.low)) == static_cast<Native>(a.low) * b.low);
    const int shift = static_cast<int>(a.low % 128);
    TEST_ASSERT_TRUE(native(shifted_left(b, shift)) == native(b) << shift);
    TEST_ASSERT_TRUE(native(shifted_right(b, shift % 64)) ==
                     static_cast<Native>(static_cast<SignedNative>(native(b)) >> shift % 64));
  }
}

TEST_HOST(products_of_fixed_point_numbers_agree_with_long_multiplication) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 100000; ++i) {
    const Wide a = any_wide(random);
    const Wide b = any_wide(random);
    // a b = (a_high 2^64 + a_low)(b_high 2^64 + b_low) >> 64, the upper halves signed
    const auto a_high = static_cast<SignedNative>(static_cast<int64_t>(a.high));
    const auto b_high = static_cast<int64_t>(b.high);
    const Native low = static_cast<Native>(a.low) * b.low >> 64;
    const auto with_low = static_cast<Native>(a_high * static_cast<SignedNative>(b.low)) + low;
    TEST_ASSERT_TRUE(native(times_fraction(a, b.low)) == with_low);
    const Native with_high = native(a) * static_cast<Native>(static_cast<SignedNative>(b_high));
    TEST_ASSERT_TRUE(native(fixed_product(a, b)) == with_low + with_high);
  }
}

#endif
