// SPDX-License-Identifier: Apache-2.0
// The test vocabulary itself, in both places it runs. Built again with STILLPOINT_PLANTED_FAILURE, and for the
// chip with STILLPOINT_PLANTED_FAULT: these must fail, or a broken runner would pass everything.
#include "shaper/base/status.hpp"
#include "tests/support/test.hpp"

namespace {

using stillpoint::Error;
using stillpoint::Quantity;
using stillpoint::refuse;

struct Counter {
  int count = 1;
};

TEST(assertions_that_hold_pass) {
  TEST_INFO(seed, 7);
  TEST_ASSERT_TRUE(1 + 1 == 2);
  TEST_ASSERT_FALSE(1 + 1 == 3);
  TEST_ASSERT_EQUAL_INT64(INT64_MIN, INT64_MIN);
  TEST_ASSERT_AT_MOST_INT64(3, 3);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1, 0.1 + 1e-13);
  TEST_ASSERT_REFUSED(kAboveMaximum, kJerk, refuse(Error::kAboveMaximum, Quantity::kJerk, 2.0, 1.0));
}

TEST_F(Counter, a_fixture_is_set_up_for_its_case) { TEST_ASSERT_EQUAL_INT32(1, count++); }
TEST_F(Counter, a_fixture_is_set_up_anew_for_the_next_case) { TEST_ASSERT_EQUAL_INT32(1, count++); }

TEST_HOST(a_host_case_runs_on_the_host) {
#ifdef STILLPOINT_CHIP_TESTS
  TEST_ASSERT_TRUE(false);
#endif
}

#ifdef STILLPOINT_PLANTED_FAULT
TEST(a_fault_ends_the_image) { __asm__ volatile("udf #0"); }
#endif

#ifdef STILLPOINT_PLANTED_FAILURE
TEST(a_nan_is_within_nothing) {
  TEST_INFO(planted, -12345);
  TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.125, __builtin_nan(""));
}
#endif

}  // namespace
