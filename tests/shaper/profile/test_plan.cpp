// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/plan.hpp"

#include "shaper/base/math.hpp"
#include "tests/support/test.hpp"

#ifndef STILLPOINT_CHIP_TESTS
#include "tests/shaper/profile/random_rest_moves.hpp"
#endif

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

constexpr double kTick = 1e-3;

Plan planned(double distance, const AxisLimits& limits, ProfileKind kind = ProfileKind::kSCurve) {
  Plan plan{};
  TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, kind, kTick, plan));
  return plan;
}

AxisLimits symmetric(double velocity, double acceleration, double jerk) {
  return AxisLimits{velocity, acceleration, acceleration, jerk};
}

// Where the plan ends, integrated segment by segment.
struct End {
  double position;
  double velocity;
  double acceleration;
  double duration;
};

End end_of(const Plan& plan) {
  End end{0.0, plan.start_velocity, 0.0, 0.0};
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const double t = plan.segments[i].duration_ticks;
    const double a = plan.segments[i].acceleration;
    const double j = plan.segments[i].jerk;
    end.position += t * (end.velocity + t * (a / 2 + t * j / 6));
    end.velocity += t * (a + t * j / 2);
    end.acceleration = a + t * j;
    end.duration += t;
  }
  return end;
}

}  // namespace

TEST(every_class_of_s_curve_takes_the_published_time) {
  const double cases[][5] = {{0.5, 1, 10, 1000, 0.61},  {0.025, 1, 10, 1000, 0.110498756}, {1, 1, 4, 40, 1.35},
                             {0.001, 1, 10, 500, 0.04}, {10, 2, 5, 10, 5.894427191},       {0.3, 5, 5, 20, 0.782973528},
                             {1.7, 1.2, 20, 600, 1.510}};
  for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
    const double* c = cases[i];
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, c[4], planned(c[0], symmetric(c[1], c[2], c[3])).optimum_ticks * kTick);
  }
}

TEST(the_trapezoid_takes_the_times_of_the_example_stage) {
  const AxisLimits stage = symmetric(1.0, 10.0, 1.0);
  TEST_ASSERT_EQUAL_UINT32(600, planned(0.5, stage, ProfileKind::kTrapezoid).duration_ticks);
  TEST_ASSERT_EQUAL_UINT32(100, planned(0.025, stage, ProfileKind::kTrapezoid).duration_ticks);
  TEST_ASSERT_EQUAL_UINT32(200, planned(0.1, stage, ProfileKind::kTrapezoid).duration_ticks);
}

TEST(a_duration_that_is_whole_but_for_rounding_takes_no_further_tick) {
  TEST_ASSERT_EQUAL_UINT32(1510, planned(1.7, symmetric(1.2, 20, 600)).duration_ticks);
  TEST_ASSERT_EQUAL_UINT32(610, planned(0.5, symmetric(1, 10, 1000)).duration_ticks);
  TEST_ASSERT_EQUAL_UINT32(111, planned(0.025, symmetric(1, 10, 1000)).duration_ticks);
}

TEST(a_move_of_nothing_takes_no_ticks) { TEST_ASSERT_EQUAL_UINT32(0, planned(0.0, symmetric(1, 1, 1)).duration_ticks); }

TEST(limits_out_of_all_proportion_give_one_tick) {
  TEST_ASSERT_EQUAL_UINT32(1, planned(1.0, symmetric(1e30, 1e30, 1e30)).duration_ticks);
}

TEST(a_stretched_plan_takes_exactly_the_ticks_asked_for_and_still_arrives) {
  Plan plan = planned(1.7, symmetric(1.2, 20, 600));
  const Peaks before = peaks_of(plan, kTick);
  TEST_ASSERT_OK(stretch(plan, 3020));
  const Peaks after = peaks_of(plan, kTick);
  const End end = end_of(plan);
  TEST_ASSERT_EQUAL_UINT32(3020, plan.duration_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-13, 3020.0, end.duration);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 1.7, end.position);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, before.velocity / 2, after.velocity);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, before.acceleration / 4, after.acceleration);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, before.jerk / 8, after.jerk);
}

TEST(bad_input_is_refused_by_name_and_the_plan_before_it_stays) {
  Plan plan = planned(1.0, symmetric(1, 2, 3));
  const double nan = __builtin_nan("");
  const double infinity = __builtin_inf();
  const auto kind = ProfileKind::kSCurve;
  const AxisLimits good = symmetric(1, 2, 3);
  TEST_ASSERT_REFUSED(kNotFinite, kDistance, plan_rest_to_rest(nan, good, kind, kTick, plan));
  TEST_ASSERT_REFUSED(kNotFinite, kDistance, plan_rest_to_rest(infinity, good, kind, kTick, plan));
  TEST_ASSERT_REFUSED(kNotFinite, kVelocity, plan_rest_to_rest(1, symmetric(nan, 1, 1), kind, kTick, plan));
  TEST_ASSERT_REFUSED(kNotPositive, kVelocity, plan_rest_to_rest(1, symmetric(0, 1, 1), kind, kTick, plan));
  TEST_ASSERT_REFUSED(kNotPositive, kAcceleration, plan_rest_to_rest(1, {1, -1, 1, 1}, kind, kTick, plan));
  TEST_ASSERT_REFUSED(kNotPositive, kDeceleration, plan_rest_to_rest(1, {1, 1, 0, 1}, kind, kTick, plan));
  TEST_ASSERT_REFUSED(kNotFinite, kJerk, plan_rest_to_rest(1, {1, 1, 1, infinity}, kind, kTick, plan));
  TEST_ASSERT_REFUSED(kNotPositive, kTick, plan_rest_to_rest(1, good, kind, 0.0, plan));
  TEST_ASSERT_REFUSED(kNotFinite, kTick, plan_rest_to_rest(1, good, kind, nan, plan));
  const Status too_long = plan_rest_to_rest(1.0, symmetric(1e-9, 1, 1), kind, kTick, plan);
  TEST_ASSERT_REFUSED(kAboveMaximum, kDuration, too_long);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, kMaxDurationTicks * kTick, too_long.accepted);
  TEST_ASSERT_REFUSED(kNotPositive, kDuration, stretch(plan, 0));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDuration, stretch(plan, kMaxDurationTicks + 1));
  TEST_ASSERT_TRUE(plan.distance == 1.0);
  TEST_ASSERT_EQUAL_UINT32(planned(1.0, good).duration_ticks, plan.duration_ticks);
}

TEST(the_same_move_in_metres_millimetres_and_counts_takes_the_same_ticks) {
  const uint64_t seed = 3;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 300; ++i) {
    TEST_INFO("case", i);
    const double distance = random.between(0.001, 2.0);
    const AxisLimits limits{random.between(0.05, 3.0), random.between(0.5, 50.0), random.between(0.5, 50.0),
                            random.between(5.0, 5000.0)};
    const Plan metres = planned(distance, limits);
    const double scales[] = {1e3, 1e6, 1e-6};
    for (unsigned k = 0; k < 3; ++k) {
      const double s = scales[k];
      const AxisLimits scaled{limits.velocity * s, limits.acceleration * s, limits.deceleration * s, limits.jerk * s};
      TEST_ASSERT_EQUAL_UINT32(metres.duration_ticks, planned(distance * s, scaled).duration_ticks);
    }
  }
}

TEST(two_jerks_give_two_ramps) {
  // 1 m/s at 10 m/s^2: up at 1000 m/s^3 takes 0.11 s, down at 100 m/s^3 0.2 s; both at half the speed in the mean.
  AxisLimits limits = symmetric(1, 10, 1000);
  limits.deceleration_jerk = 100;
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.11 + 0.2 + (0.5 - 0.055 - 0.1), planned(0.5, limits).optimum_ticks * kTick);
  // No cruise, neither reaches its acceleration: v^(3/2) (1/sqrt(j1) + 1/sqrt(j2)) = s, T = 2 s / v.
  limits = AxisLimits{10, 100, 100, 100, 900};
  const double distance = 0.1;
  const double per_pace = distance / (1.0 / 10.0 + 1.0 / 30.0);
  const double peak = math::cbrt(per_pace * per_pace);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 2.0 * distance / peak, planned(distance, limits).optimum_ticks * kTick);
}

#ifndef STILLPOINT_CHIP_TESTS

TEST_HOST(random_moves_of_all_classes_take_the_time_of_bisection_within_the_limits_of_each_ramp) {
  constexpr int kPlans = 100000;
  const uint64_t seed = 42;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < kPlans; ++i) {
    TEST_INFO("case", i);
    const char* fault = stillpoint::testing::fault_of_rest_move(random);
    TEST_INFO("fault", fault);
    TEST_ASSERT_TRUE(fault == nullptr);
  }
  MESSAGE("plans that take the ticks of the bisected optimum, or one more: ", kPlans);
}

#endif
