// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/track.hpp"

#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

#ifndef STILLPOINT_CHIP_TESTS
#include <cmath>
#endif

using namespace stillpoint;
using stillpoint::testing::Random;
using stillpoint::testing::StreamCheck;

namespace {

constexpr double kTick = 1e-3;

struct Run {
  Track track;
  Sampler sampler;
  void begin(const Plan& plan, Signal start, Signal target) {
    Track::make(plan, start, target, track);
    sampler.begin(track);
  }
};

Plan planned(double distance, const AxisLimits& limits, ProfileKind kind = ProfileKind::kSCurve) {
  Plan plan{};
  TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, kind, kTick, plan));
  return plan;
}

// Runs the whole move and three ticks more, and checks arrival and limits.
void check_move(const Plan& plan, const AxisLimits& limits, int32_t start_counts, int32_t target_counts,
                ProfileKind kind) {
  const Signal start = signal_from_counts(start_counts);
  const Signal target = signal_from_counts(target_counts);
  Run run;
  run.begin(plan, start, target);
  StreamCheck check(start, target >= start, limits, kTick);
  for (uint32_t tick = 1; tick <= plan.duration_ticks + 3; ++tick) {
    const Signal signal = run.sampler.tick();
    check.next(signal);
    if (tick >= plan.duration_ticks) TEST_ASSERT_EQUAL_INT64(target, signal);
  }
  TEST_ASSERT_TRUE(run.sampler.at_rest());
  TEST_INFO("velocity excess LSB", check.velocity_excess);
  TEST_INFO("acceleration excess LSB", check.acceleration_excess);
  TEST_INFO("jerk excess LSB", check.jerk_excess);
  TEST_ASSERT_TRUE(check.within(0, kind == ProfileKind::kSCurve));
  TEST_ASSERT_AT_MOST_DOUBLE(1.0, check.backwards);
}

}  // namespace

TEST(a_sampler_at_rest_stays_where_it_is) {
  Sampler sampler;
  sampler.rest_at(-5);
  TEST_ASSERT_EQUAL_INT64(-5, sampler.tick());
  TEST_ASSERT_TRUE(sampler.at_rest());
}

TEST(a_move_of_one_count_arrives_within_its_limits) {
  const AxisLimits limits{1200.0, 20e3, 30e3, 600e3};
  check_move(planned(1.0, limits), limits, 7, 8, ProfileKind::kSCurve);
  check_move(planned(-1.0, limits), limits, -7, -8, ProfileKind::kSCurve);
}

TEST(the_longest_move_arrives_within_its_limits) {
  const AxisLimits limits{3e9, 4e10, 2e10, 2e12};
  check_move(planned(2147483647.0, limits), limits, INT32_MIN, -1, ProfileKind::kSCurve);
  check_move(planned(-2147483647.0, limits), limits, INT32_MAX, 0, ProfileKind::kSCurve);
}

TEST(a_move_in_one_tick_is_a_step) {
  const AxisLimits limits{1e12, 1e18, 1e18, 1e24};
  check_move(planned(100.0, limits), limits, 0, 100, ProfileKind::kSCurve);
}

TEST(the_reference_move_samples_the_continuous_plan) {
  const AxisLimits limits{1.2e6, 20e6, 20e6, 600e6};
  const Plan plan = planned(1.7e6, limits);
  Run run;
  run.begin(plan, 0, signal_from_counts(1700000));
  // The first jerk phase lasts 33.3 ticks: position j t^3 / 6, off the grid nowhere.
  for (uint32_t tick = 1; tick <= 33; ++tick) {
    const double expected = 0.6 * tick * tick * tick / 6.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, expected, static_cast<double>(run.sampler.tick()) / 4294967296.0);
  }
}

#ifndef STILLPOINT_CHIP_TESTS

TEST(a_sampler_that_begins_within_a_move_goes_on_as_one_that_came_there) {
  const Plan plan = planned(-123456.0, {1.2e6, 20e6, 30e6, 600e6});
  Run run;
  run.begin(plan, signal_from_counts(7), signal_from_counts(7 - 123456));
  for (uint32_t tick = 0; tick <= plan.duration_ticks + 1; ++tick) {
    TEST_INFO("tick", tick);
    Sampler other;
    other.begin_at(run.track, tick);
    TEST_ASSERT_EQUAL_INT64(run.sampler.position(), other.position());
    Sampler on = run.sampler;
    for (int i = 0; i < 40; ++i) TEST_ASSERT_EQUAL_INT64(on.tick(), other.tick());
    TEST_ASSERT_TRUE(on.at_rest() == other.at_rest());
    run.sampler.tick();
  }
}

TEST_HOST(a_segment_of_a_million_ticks_errs_by_less_than_an_lsb) {
  // GIVEN one segment from a moving state, in numbers that binary cannot hold
  const uint64_t seed = 8;
  TEST_INFO("seed", seed);
  Random random(seed);
  constexpr uint32_t kTicks = 1000000;
  for (int i = 0; i < 20; ++i) {
    TEST_INFO("case", i);
    const double jerk = random.between(-1.0, 1.0) * 1.2e-9;
    const double acceleration = random.between(-1.0, 1.0) * 4e-4;
    const double velocity = random.between(-1.0, 1.0) * 300.0;
    Plan plan{};
    plan.duration_ticks = kTicks + 2;
    plan.start_velocity = velocity;
    plan.segment_count = 1;
    plan.segments[0] = Segment{static_cast<double>(kTicks + 2), acceleration, jerk};
    Track track{};
    Track::make_uncorrected(plan, 0, track);
    Sampler sampler;
    sampler.begin(track);
    // WHEN it is sampled for a million ticks THEN every sample is the cubic, evaluated apart in 80-bit floating point
    // whose own error is allowed for (x86 long double: 64 bits of mantissa, three roundings)
    for (uint32_t tick = 1; tick <= kTicks; ++tick) {
      const long double t = tick;
      const long double exact = t * (velocity + t * (acceleration / 2.0L + t * (jerk / 6.0L)));
      const long double error = std::fabs(static_cast<long double>(sampler.tick()) / 4294967296.0L - exact);
      const long double oracle_error = 3e-19L * (std::fabs(t * velocity) + t * t * std::fabs(acceleration));
      if (error > 1.0L / 4294967296.0L + oracle_error) TEST_ASSERT_EQUAL_UINT32(0, tick);
    }
  }
}

TEST_HOST(random_moves_over_all_distances_and_classes_keep_their_limits) {
  const uint64_t seed = 1;
  TEST_INFO("seed", seed);
  Random random(seed);
  int done = 0;
  for (int i = 0; done < 100000; ++i) {
    TEST_INFO("case", i);
    const double distance = std::floor(std::pow(10.0, random.between(0.0, 8.5)));
    const double velocity = distance * std::pow(10.0, random.between(-1.0, 3.0));
    const double acceleration = velocity * std::pow(10.0, random.between(-1.0, 3.0));
    const double deceleration = random.next() % 2 == 0 ? acceleration : acceleration * random.between(0.1, 10.0);
    const AxisLimits limits{velocity, acceleration, deceleration, acceleration * std::pow(10.0, random.between(-1, 4))};
    const auto kind = random.next() % 4 == 0 ? ProfileKind::kTrapezoid : ProfileKind::kSCurve;
    const bool forward = random.next() % 2 == 0;
    const Plan plan = planned(forward ? distance : -distance, limits, kind);
    if (plan.duration_ticks > 3000) continue;
    ++done;
    const int32_t start = static_cast<int32_t>(random.integer(-1000000000, 1000000000));
    const int32_t target = start + static_cast<int32_t>(forward ? distance : -distance);
    check_move(plan, limits, start, target, kind);
  }
  MESSAGE("moves within their limits: ", done);
}

TEST_HOST(long_moves_with_high_jerk_limits_keep_their_limits_too) {
  const uint64_t seed = 20261122;
  TEST_INFO("seed", seed);
  Random random(seed);
  int done = 0;
  for (int i = 0; done < 300; ++i) {
    TEST_INFO("case", i);
    const double duration_s = std::pow(10.0, random.between(1.0, 3.3));
    const double distance = std::floor(std::pow(10.0, random.between(2.0, 9.3)));
    const double velocity = distance / duration_s;
    const double acceleration = velocity * std::pow(10.0, random.between(-0.5, 3.0));
    const AxisLimits limits{velocity, acceleration, acceleration * random.between(0.5, 2.0),
                            acceleration * std::pow(10.0, random.between(0.0, 30.0))};
    const auto kind = random.next() % 4 == 0 ? ProfileKind::kTrapezoid : ProfileKind::kSCurve;
    const Plan plan = planned(distance, limits, kind);
    if (plan.duration_ticks > 2000000 || plan.duration_ticks < 10000) continue;
    ++done;
    check_move(plan, limits, -1000000000, -1000000000 + static_cast<int32_t>(distance), kind);
  }
}

TEST_HOST(limits_past_any_use_keep_the_others) {
  const uint64_t seed = 300;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 20000; ++i) {
    TEST_INFO("case", i);
    const double distance = std::floor(std::pow(10.0, random.between(0.0, 8.0)));
    const double velocity = distance * std::pow(10.0, random.between(-0.3, 4.0));
    const double acceleration = velocity * std::pow(10.0, random.between(0.0, 50.0));
    const AxisLimits limits{velocity, acceleration, acceleration * random.between(0.5, 2.0),
                            acceleration * std::pow(10.0, random.between(3.0, 200.0))};
    const auto kind = random.next() % 4 == 0 ? ProfileKind::kTrapezoid : ProfileKind::kSCurve;
    check_move(planned(-distance, limits, kind), limits, 0, -static_cast<int32_t>(distance), kind);
  }
}

#endif
