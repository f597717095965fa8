// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/plan_from.hpp"

#include "shaper/profile/track.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;
constexpr AxisLimits kLimits{1.0, 10.0, 10.0, 1000.0};

Plan planned(const StartMotion& start, double distance, const AxisLimits& limits = kLimits) {
  Plan plan{};
  TEST_ASSERT_OK(plan_from(start, distance, limits, kTick, plan));
  return plan;
}

double seconds(const Plan& plan) { return plan.optimum_ticks * kTick; }

}  // namespace

TEST(from_rest_it_takes_the_published_times) {
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.61, seconds(planned({0, 0}, 0.5)));
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.110498756, seconds(planned({0, 0}, -0.025)));
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.04, seconds(planned({0, 0}, 0.001, {1, 10, 10, 500})));
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5.894427191, seconds(planned({0, 0}, 10, {2, 5, 5, 10})));
}

TEST(at_rest_on_the_target_it_takes_no_ticks) { TEST_ASSERT_EQUAL_UINT32(0, planned({0, 0}, 0).duration_ticks); }

TEST(a_cruising_axis_told_its_stopping_distance_stops_at_once) {
  // From 1 m/s with 10 m/s^2 and 1000 m/s^3: 0.11 s, in the mean at half the speed.
  const Plan plan = planned({-1.0, 0.0}, -0.055);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.11, seconds(plan));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, plan.segments[0].acceleration);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 1e-6, plan.segments[0].jerk);
}

TEST(braking_and_a_target_a_little_beyond_the_stop_it_eases_off_but_keeps_braking) {
  const StartMotion braking{1.0, -10.0};
  Plan stop{};
  TEST_ASSERT_OK(plan_to_velocity(braking, 0.0, kLimits, kTick, stop));
  const Plan plan = planned(braking, stop.distance * 1.01);
  // Letting go of the braking altogether and taking it up again would take more.
  TEST_ASSERT_AT_MOST_DOUBLE(stop.optimum_ticks * 1.05, plan.optimum_ticks);
  TEST_ASSERT_AT_LEAST_DOUBLE(stop.optimum_ticks, plan.optimum_ticks);
  for (uint32_t i = 0; i < plan.segment_count; ++i) TEST_ASSERT_AT_MOST_DOUBLE(0.0, plan.segments[i].acceleration);
}

TEST(a_target_before_the_stop_is_passed_and_come_back_to) {
  const Plan plan = planned({1.0, 0.0}, 0.0);
  // Stop, and 0.055 m back from rest: it turns without letting go, so in less than the two one after the other.
  TEST_ASSERT_AT_MOST_DOUBLE(0.11 + seconds(planned({0, 0}, -0.055)), seconds(plan));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, plan.distance);
}

TEST(deceleration_turns_into_acceleration_at_the_turning_point) {
  // GIVEN a deceleration of twice the acceleration WHEN it turns round THEN the higher is let go of by then
  const AxisLimits limits{1.0, 5.0, 10.0, 1000.0};
  const Plan plan = planned({-1.0, 0.0}, 1.0, limits);
  double velocity = plan.start_velocity;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& s = plan.segments[i];
    const double limit = velocity < -1e-12 ? 10e-6 : 5e-6;
    if (s.acceleration > 0.0) TEST_ASSERT_AT_MOST_DOUBLE(limit * (1 + 1e-12), s.acceleration);
    velocity += s.duration_ticks * (s.acceleration + s.duration_ticks * s.jerk / 2.0);
  }
}

TEST(each_jerk_holds_on_its_side_of_the_turning_point) {
  // GIVEN a jerk for braking of a quarter WHEN it turns round THEN the jerk changes where the velocity is zero
  const AxisLimits limits{1.0, 10.0, 10.0, 1000.0, 250.0};
  const Plan plan = planned({-1.0, 0.0}, 1.0, limits);
  double velocity = plan.start_velocity;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& s = plan.segments[i];
    const double half_way = velocity + s.duration_ticks / 2.0 * (s.acceleration + s.duration_ticks * s.jerk / 4.0);
    const bool speeds_up = (half_way > 0.0) == (s.acceleration + s.jerk * s.duration_ticks / 2.0 > 0.0);
    const double jerk = s.jerk < 0.0 ? -s.jerk : s.jerk;
    TEST_ASSERT_AT_MOST_DOUBLE((speeds_up ? 1e-6 : 0.25e-6) * (1 + 1e-12), jerk);
    velocity += s.duration_ticks * (s.acceleration + s.duration_ticks * s.jerk / 2.0);
  }
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 40.0, plan.segments[0].duration_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, 1e-6, -plan.segments[2].jerk);
}

TEST(from_above_the_velocity_limit_it_slows_down_with_the_deceleration) {
  const Plan plan = planned({3.0, 0.0}, 5.0);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, -1e-6, plan.segments[0].jerk);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, -10e-6, plan.segments[1].acceleration);
  // 3 to 1 m/s: 0.21 s over 0.42 m; 0.11 s over 0.055 m at the end; the rest at 1 m/s.
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.21 + 0.11 + (5.0 - 0.42 - 0.055), seconds(plan));
}

TEST(from_above_its_limit_the_acceleration_comes_back_first) {
  const Plan plan = planned({0.0, 25.0}, 5.0);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 25e-6, plan.segments[0].acceleration);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, -1e-6, plan.segments[0].jerk);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 15.0, plan.segments[0].duration_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 10e-6, plan.segments[1].acceleration);
}

TEST(a_velocity_is_reached_and_held_to_the_end_of_the_tick) {
  Plan plan{};
  TEST_ASSERT_OK(plan_to_velocity({0.0, 0.0}, 0.5, {1.0, 10.0, 10.0, 2000.0}, kTick, plan));
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 55.0, plan.optimum_ticks);
  TEST_ASSERT_OK(plan_to_velocity({0.0, 0.0}, -0.5005, {1.0, 10.0, 10.0, 2000.0}, kTick, plan));
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 55.05, plan.optimum_ticks);
  TEST_ASSERT_EQUAL_UINT32(56, plan.duration_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, -0.5005 * kTick * (55.05 / 2 + 0.95), plan.distance);
}

TEST(a_track_samples_the_plan_from_its_start_and_ends_on_the_target) {
  // GIVEN a start in motion, in counts
  const AxisLimits limits{1.2e6, 20e6, 30e6, 600e6};
  const Plan plan = planned({6e5, -4e6}, -123456.0, limits);
  Track track{};
  Track::make(plan, signal_from_counts(7), signal_from_counts(7 - 123456), track);
  Sampler sampler;
  sampler.begin(track);
  // THEN the first tick has moved by v + a/2 + j/6
  const double expected = 7.0 + 600.0 - 4.0 / 2.0 - 0.6 / 6.0;
  TEST_ASSERT_DOUBLE_WITHIN(1e-8, expected, static_cast<double>(sampler.tick()) / 4294967296.0);
  for (uint32_t tick = 1; tick < plan.duration_ticks; ++tick) sampler.tick();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(7 - 123456), sampler.position());
  TEST_ASSERT_TRUE(sampler.at_rest());
}

TEST(bad_starts_and_goals_are_refused_by_name_and_the_plan_before_stays) {
  Plan plan = planned({0, 0}, 0.5);
  const double nan = __builtin_nan("");
  TEST_ASSERT_REFUSED(kNotFinite, kVelocity, plan_from({nan, 0}, 1, kLimits, kTick, plan));
  TEST_ASSERT_REFUSED(kNotFinite, kAcceleration, plan_from({0, __builtin_inf()}, 1, kLimits, kTick, plan));
  TEST_ASSERT_REFUSED(kNotFinite, kDistance, plan_from({0, 0}, nan, kLimits, kTick, plan));
  TEST_ASSERT_REFUSED(kNotPositive, kJerk, plan_from({0, 0}, 1, {1, 1, 1, 0}, kTick, plan));
  TEST_ASSERT_REFUSED(kNotPositive, kTick, plan_from({0, 0}, 1, kLimits, 0, plan));
  TEST_ASSERT_REFUSED(kNotFinite, kVelocity, plan_to_velocity({0, 0}, nan, kLimits, kTick, plan));
  TEST_ASSERT_REFUSED(kAboveMaximum, kVelocity, plan_to_velocity({0, 0}, -1.5, kLimits, kTick, plan));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDuration, plan_from({0, 0}, 1, {1e-9, 1, 1, 1}, kTick, plan));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDuration, plan_from({1e300, 1e300}, 1, kLimits, kTick, plan));
  TEST_ASSERT_TRUE(plan.distance == 0.5);
}
