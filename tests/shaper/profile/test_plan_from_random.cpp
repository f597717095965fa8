// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/plan_from.hpp"
#include "tests/shaper/profile/random_moves.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

TEST_HOST(from_rest_the_plan_is_that_from_rest_to_rest) {
  const uint64_t seed = 5;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 20000; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = testing::random_limits(random, 4.0);
    const double distance = limits.velocity * std::pow(10.0, random.between(-4.0, 2.0));
    Plan rest{};
    Plan any{};
    TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, ProfileKind::kSCurve, 1e-4, rest));
    TEST_ASSERT_OK(plan_from(StartMotion{0.0, 0.0}, distance, limits, 1e-4, any));
    const double strongest = std::fmax(limits.acceleration, limits.deceleration);
    if (limits.larger_jerk() * 1e-4 <= 1024.0 * strongest) {
      TEST_ASSERT_DOUBLE_RELATIVE(1e-12, rest.optimum_ticks, any.optimum_ticks);
    } else {  // not all of such a jerk is used
      TEST_ASSERT_DOUBLE_WITHIN(1.0, rest.optimum_ticks, any.optimum_ticks);
    }
  }
}

namespace {

void check_against_the_search(uint64_t seed, bool two_jerks) {
  TEST_INFO("seed", seed);
  Random random(seed);
  testing::Comparison result;
  for (int i = 0; i < 6; ++i) {
    testing::LatticeLimits lattice{static_cast<int>(random.integer(1, 5)), static_cast<int>(random.integer(1, 5)),
                                   static_cast<int>(random.integer(6, 24))};
    if (two_jerks) (i % 2 == 0 ? lattice.jerk : lattice.braking_jerk) = 2;
    compare(random, testing::LatticeOptimum(lattice, 1500), lattice, 1000, result);
  }
  TEST_INFO("worst, ticks", result.worst_ticks);
  TEST_ASSERT_EQUAL_INT64(0, result.slower);
  TEST_ASSERT_AT_LEAST_INT64(500, result.braking);
  TEST_ASSERT_AT_LEAST_INT64(result.states / 3, result.same_ticks);  // the search is near, so this is a comparison
}

}  // namespace

TEST_HOST(no_sequence_of_jerks_is_faster) { check_against_the_search(11, false); }

TEST_HOST(no_sequence_of_jerks_is_faster_with_a_jerk_for_braking) { check_against_the_search(12, true); }

namespace {

void check_all(uint64_t seed, int count, const char* (*fault_of)(Random&)) {
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    TEST_INFO("case", i);
    const char* fault = fault_of(random);
    TEST_INFO("fault", fault);
    TEST_ASSERT_TRUE(fault == nullptr);
  }
}

}  // namespace

TEST_HOST(random_moves_arrive_within_their_limits_and_stay_optimal_on_the_way) {
  check_all(21, 5000, [](Random& random) { return testing::fault_of_move(random, 3.0); });
}

TEST_HOST(limits_a_million_times_apart_are_planned_for) {
  check_all(22, 5000, [](Random& random) { return testing::fault_of_move(random, 12.0); });
}

TEST_HOST(random_changes_of_velocity_arrive_within_their_limits) {
  check_all(23, 5000, [](Random& random) { return testing::fault_of_velocity_change(random, 4.0); });
}

TEST_HOST(from_outside_the_limits_it_comes_back_without_passing_them_further) {
  check_all(25, 5000, testing::fault_of_outside_start);
}

TEST_HOST(random_moves_in_counts_are_sampled_within_their_limits) { check_all(24, 1000, testing::fault_of_stream); }
