// SPDX-License-Identifier: Apache-2.0
// Unity-style test vocabulary. On the host it expands to doctest, on the chip to the runner in chip_runner.hpp, so the
// same test file runs in both places. A case is flat and named after the behaviour:
//
//   TEST(a_move_of_zero_counts_takes_no_ticks) { TEST_ASSERT_EQUAL_UINT32(0, plan(0).duration_ticks); }
//
//   struct AtRest { Axis<64> axis; AtRest() { ... } };          // the set-up
//   TEST_F(AtRest, a_command_is_refused_while_moving) { ... }   // has `axis` in scope
//
// TEST_HOST and TEST_HOST_F: cases that need libm, long double, the standard library or minutes of chip time.
#pragma once

#include <stdint.h>

#include "tests/support/random.hpp"

#if defined(__STDC_HOSTED__) && __STDC_HOSTED__ && !defined(STILLPOINT_CHIP_TESTS)

#include <doctest/doctest.h>

#define TEST(name) TEST_CASE(#name)
#define TEST_F(fixture, name) TEST_CASE_FIXTURE(fixture, #name)
#define TEST_HOST(name) TEST(name)
#define TEST_HOST_F(fixture, name) TEST_F(fixture, name)
// What was going on when an assertion failed (a seed, a case number): shown with the failure, free otherwise.
#define TEST_INFO(name, value) CAPTURE(value)

#define TEST_ASSERT_TRUE(condition) REQUIRE((condition))
#define TEST_ASSERT_FALSE(condition) REQUIRE_FALSE((condition))
#define TEST_ASSERT_COMPARE_(type, expected, op, actual) \
  REQUIRE(static_cast<type>(expected) op static_cast<type>(actual))

#else
#include "tests/support/chip_runner.hpp"
#endif

#define TEST_ASSERT_EQUAL_INT32(expected, actual) TEST_ASSERT_COMPARE_(int32_t, expected, ==, actual)
#define TEST_ASSERT_EQUAL_UINT32(expected, actual) TEST_ASSERT_COMPARE_(uint32_t, expected, ==, actual)
#define TEST_ASSERT_EQUAL_INT64(expected, actual) TEST_ASSERT_COMPARE_(int64_t, expected, ==, actual)
#define TEST_ASSERT_EQUAL_UINT64(expected, actual) TEST_ASSERT_COMPARE_(uint64_t, expected, ==, actual)
// actual <= limit, actual >= limit
#define TEST_ASSERT_AT_MOST_INT64(limit, actual) TEST_ASSERT_COMPARE_(int64_t, limit, >=, actual)
#define TEST_ASSERT_AT_LEAST_INT64(limit, actual) TEST_ASSERT_COMPARE_(int64_t, limit, <=, actual)
#define TEST_ASSERT_AT_MOST_DOUBLE(limit, actual) TEST_ASSERT_COMPARE_(double, limit, >=, actual)
#define TEST_ASSERT_AT_LEAST_DOUBLE(limit, actual) TEST_ASSERT_COMPARE_(double, limit, <=, actual)
// |actual - expected| <= delta; a NaN fails
#define TEST_ASSERT_DOUBLE_WITHIN(delta, expected, actual) \
  TEST_ASSERT_COMPARE_(double, delta, >=, stillpoint::testing::distance(expected, actual))
// |actual - expected| <= relative * |expected|
#define TEST_ASSERT_DOUBLE_RELATIVE(relative, expected, actual)                             \
  TEST_ASSERT_COMPARE_(double, (relative)*stillpoint::testing::distance(expected, 0.0), >=, \
                       stillpoint::testing::distance(expected, actual))
// enum class values (Error, Quantity, states, ...)
#define TEST_ASSERT_EQUAL_ENUM(expected, actual) \
  TEST_ASSERT_COMPARE_(int32_t, static_cast<int32_t>(expected), ==, static_cast<int32_t>(actual))
// a Status that is a success / that refuses with this error about this quantity
#define TEST_ASSERT_OK(status) TEST_ASSERT_EQUAL_ENUM(stillpoint::Error::kNone, (status).error)
#define TEST_ASSERT_REFUSED(expected_error, expected_quantity, ...)                            \
  do {                                                                                         \
    const stillpoint::Status refused_status_ = (__VA_ARGS__);                                  \
    TEST_ASSERT_EQUAL_ENUM(stillpoint::Error::expected_error, refused_status_.error);          \
    TEST_ASSERT_EQUAL_ENUM(stillpoint::Quantity::expected_quantity, refused_status_.quantity); \
  } while (false)

namespace stillpoint::testing {

inline double distance(double expected, double actual) {
  return expected < actual ? actual - expected : expected - actual;
}

}  // namespace stillpoint::testing
