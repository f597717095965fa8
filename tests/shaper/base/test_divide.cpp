// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/divide.hpp"

#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

TEST(a_quotient_is_that_of_the_machine) {
  static_assert(divide(0, 1) == 0 && divide(41, 42) == 0 && divide(42, 42) == 1 && divide(UINT64_MAX, 1) == UINT64_MAX);
  static_assert(divide(UINT64_MAX, UINT64_MAX) == 1 && divide(UINT64_C(1) << 63, 3) == UINT64_C(3074457345618258602));
  const uint64_t seed = 3;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 2000; ++i) {
    const uint64_t dividend = random.next() >> random.integer(0, 63);
    const uint64_t divisor = (random.next() >> random.integer(0, 63)) | 1U;
    TEST_INFO("dividend", dividend);
    TEST_INFO("divisor", divisor);
    TEST_ASSERT_EQUAL_UINT64(dividend / divisor, divide(dividend, divisor));
  }
}
