// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/shaper/axis/flights.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

TEST_HOST(two_thousand_flights_of_ten_commands_keep_every_limit) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  const auto flights = std::make_unique<testing::RandomFlights>(seed);
  for (int flight = 0; flight < 2000; ++flight) {
    TEST_INFO("flight", flight);
    const char* const fault = flights->fly();
    TEST_INFO("fault", fault);
    TEST_ASSERT_TRUE(fault == nullptr);
  }
  TEST_ASSERT_AT_LEAST_INT64(5000, flights->in_motion);
  TEST_ASSERT_AT_MOST_INT64(2000, flights->stopped_ticks);
}
