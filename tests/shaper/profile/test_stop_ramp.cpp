// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/stop_ramp.hpp"

#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

constexpr double kTick = 1e-3;

int64_t magnitude(int64_t value) { return value < 0 ? -value : value; }

StopLimits made(double deceleration, double jerk) {
  StopLimits limits{};
  TEST_ASSERT_OK(StopLimits::make(deceleration, jerk, kTick, limits));
  return limits;
}

// Stops from `velocity` and `acceleration` (LSB per tick^n), checks every tick, returns the ticks it took.
uint32_t ticks_to_stop(const StopLimits& limits, int64_t velocity, int64_t acceleration, uint32_t give_up) {
  StopRamp ramp;
  Signal last = 0;
  ramp.start(limits, last, last - velocity, last - velocity - (velocity - acceleration));
  const int64_t allowed = limits.deceleration > magnitude(acceleration) ? limits.deceleration : magnitude(acceleration);
  uint32_t ticks = 0;
  for (; !ramp.at_rest() && ticks < give_up; ++ticks) {
    const Signal next = ramp.tick();
    const int64_t change = next - last - velocity;
    TEST_ASSERT_AT_MOST_INT64(limits.jerk_step, magnitude(change - acceleration));
    TEST_ASSERT_AT_MOST_INT64(allowed, magnitude(change));
    velocity = next - last;
    acceleration = change;
    last = next;
  }
  TEST_ASSERT_TRUE(ramp.at_rest());
  TEST_ASSERT_EQUAL_INT64(last, ramp.tick());
  return ticks;
}

}  // namespace

TEST(a_ramp_from_rest_is_at_rest) {
  StopRamp ramp;
  ramp.start(made(1e6, 1e8), 42, 42, 42);
  TEST_ASSERT_TRUE(ramp.at_rest());
  TEST_ASSERT_EQUAL_INT64(42, ramp.tick());
}

TEST(a_stop_from_cruise_takes_the_time_of_its_limits) {
  // 1.2e6 counts/s at 40e6 counts/s^2 and 2e9 counts/s^3: v/a + a/j = 50 ticks.
  const uint32_t ticks = ticks_to_stop(made(40e6, 2e9), signal_from_counts(1200), 0, 1000);
  TEST_ASSERT_AT_LEAST_INT64(50, ticks);
  TEST_ASSERT_AT_MOST_INT64(52, ticks);
}

TEST(an_acceleration_in_either_direction_is_let_go_first) {
  const StopLimits limits = made(40e6, 2e9);
  const int64_t acceleration = signal_from_counts(17);
  ticks_to_stop(limits, signal_from_counts(300), acceleration, 1000);
  ticks_to_stop(limits, signal_from_counts(300), -acceleration, 1000);
  ticks_to_stop(limits, signal_from_counts(-1), acceleration, 1000);
  ticks_to_stop(limits, 0, acceleration, 1000);
  ticks_to_stop(limits, 1, -3, 1000);
}

TEST(stops_from_random_states_keep_their_limits_and_end) {
  const uint64_t seed = 77;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 400; ++i) {
    TEST_INFO("case", i);
    const double deceleration = random.between(1e5, 1e8);
    const double jerk = deceleration * random.between(0.5, 300.0) * random.between(1.0, 10.0);
    const StopLimits limits = made(deceleration, jerk);
    const int64_t velocity = random.integer(-limits.deceleration * 400, limits.deceleration * 400);
    const int64_t acceleration = random.integer(-limits.deceleration * 3 / 2, limits.deceleration * 3 / 2);
    // v/a + a/j and what undoing the acceleration costs, doubled for reversals
    const double levels = static_cast<double>(limits.deceleration / limits.jerk_step);
    ticks_to_stop(limits, velocity, acceleration, 500 + static_cast<uint32_t>(8 * levels));
  }
}

TEST(a_jerk_above_the_deceleration_gives_one_level) {
  const StopLimits limits = made(1e6, 1e12);
  TEST_ASSERT_EQUAL_INT64(limits.deceleration, limits.jerk_step);
  TEST_ASSERT_EQUAL_UINT32(11, ticks_to_stop(limits, signal_from_counts(10), 0, 100));
}

TEST(limits_of_a_few_lsb_still_brake) {
  const double lsb = 1e6 / 4294967296.0;  // of deceleration, in counts/s^2
  const StopLimits limits = made(1.5 * lsb, 1.0 * lsb * 1e3);
  TEST_ASSERT_EQUAL_INT64(1, limits.jerk_step);
  ticks_to_stop(limits, 10, 0, 100);
}

TEST(bad_limits_are_refused_by_name_and_change_nothing) {
  StopLimits limits = made(1e6, 1e8);
  const StopLimits before = limits;
  TEST_ASSERT_REFUSED(kNotFinite, kDeceleration, StopLimits::make(__builtin_nan(""), 1, kTick, limits));
  TEST_ASSERT_REFUSED(kNotPositive, kDeceleration, StopLimits::make(0, 1, kTick, limits));
  TEST_ASSERT_REFUSED(kNotPositive, kJerk, StopLimits::make(1, -1, kTick, limits));
  TEST_ASSERT_REFUSED(kNotPositive, kTick, StopLimits::make(1, 1, 0, limits));
  TEST_ASSERT_REFUSED(kBelowMinimum, kDeceleration, StopLimits::make(1e-9, 1, kTick, limits));
  TEST_ASSERT_REFUSED(kBelowMinimum, kJerk, StopLimits::make(1, 1e-9, kTick, limits));
  TEST_ASSERT_EQUAL_INT64(before.deceleration, limits.deceleration);
  TEST_ASSERT_EQUAL_INT64(before.jerk_step, limits.jerk_step);
}

TEST(a_stop_at_the_end_of_the_position_range_stands_there) {
  StopRamp ramp;
  const Signal end = signal_from_counts(INT32_MAX);
  ramp.start(made(1e6, 1e8), end, end - signal_from_counts(1000), end - signal_from_counts(2000));
  Signal last = 0;
  for (int i = 0; i < 5; ++i) last = ramp.tick();
  TEST_ASSERT_TRUE(ramp.at_rest());
  TEST_ASSERT_EQUAL_INT64(end, last);
}
