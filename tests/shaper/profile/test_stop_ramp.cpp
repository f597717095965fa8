// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/stop_ramp.hpp"

#include "shaper/profile/braking.hpp"
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
    TEST_ASSERT_AT_MOST_INT64(limits.jerk, magnitude(change - acceleration));
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
    // 400 for the cruise, and the ramps: what undoing the acceleration costs, a reversal with it
    const double ramp = static_cast<double>(limits.deceleration) / static_cast<double>(limits.jerk);
    ticks_to_stop(limits, velocity, acceleration, 500 + static_cast<uint32_t>(8 * ramp));
  }
}

TEST(a_jerk_above_the_deceleration_brakes_at_once) {
  // 10 counts a tick at 1 count/tick^2: 10 ticks, and one to let the braking go
  TEST_ASSERT_EQUAL_UINT32(11, ticks_to_stop(made(1e6, 1e12), signal_from_counts(10), 0, 100));
}

TEST(limits_become_the_next_whole_lsb) {
  const double lsb = 1e6 / 4294967296.0;  // of deceleration, in counts/s^2
  const StopLimits limits = made(2.5 * lsb, 1.25 * lsb * 1e3);
  TEST_ASSERT_EQUAL_INT64(3, limits.deceleration);
  TEST_ASSERT_EQUAL_INT64(2, limits.jerk);
}

TEST(limits_of_a_few_lsb_keep_their_time) {
  // v/a + a/j = 100 + 3.3 ticks, both roundings of the limits on the quick side
  const double lsb = 1e6 / 4294967296.0;
  const uint32_t ticks = ticks_to_stop(made(9.5 * lsb, 2.9 * lsb * 1e3), 950, 0, 1000);
  TEST_ASSERT_AT_MOST_INT64(105, ticks);
  TEST_ASSERT_AT_LEAST_INT64(98, ticks);
}

TEST(limits_above_all_numbers_stop_at_once) {
  const StopLimits limits = made(1e30, 1e300);
  TEST_ASSERT_EQUAL_UINT32(2, ticks_to_stop(limits, INT64_C(1) << 61, -12345, 10));
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
  TEST_ASSERT_EQUAL_INT64(before.jerk, limits.jerk);
}

TEST(a_stop_beyond_the_end_of_the_position_range_wraps) {
  // GIVEN the same motion at the end of the range and in its middle THEN the same stop, modulo 2^64
  const StopLimits limits = made(1e6, 1e8);
  const Signal end = signal_from_counts(INT32_MAX);
  const Signal step = signal_from_counts(1000);
  for (int direction = -1; direction <= 1; direction += 2) {
    const Signal from = direction > 0 ? end : -end;
    StopRamp there, middle;
    there.start(limits, from, from - direction * step, from - 2 * direction * step);
    middle.start(limits, 0, -direction * step, -2 * direction * step);
    while (!middle.at_rest()) {
      const Signal expected = wrapping_sum(from, middle.tick());
      TEST_ASSERT_EQUAL_INT64(expected, there.tick());
    }
    TEST_ASSERT_TRUE(there.at_rest());
    TEST_ASSERT_TRUE((direction > 0) == (there.tick() < 0));
  }
}

TEST(samples_on_both_sides_of_the_end_of_the_range_are_one_motion) {
  const StopLimits limits = made(1e6, 1e8);
  StopRamp there, middle;
  there.start(limits, INT64_MIN + 500, INT64_MAX - 499, INT64_MAX - 1599);
  middle.start(limits, 0, -1000, -2100);
  for (int tick = 0; tick < 5; ++tick) {
    const Signal expected = wrapping_sum(INT64_MIN + 500, middle.tick());
    TEST_ASSERT_EQUAL_INT64(expected, there.tick());
  }
}

TEST(no_state_is_too_fast) {
  // Whatever the last three outputs were: bounded work, and with limits that can, rest.
  const uint64_t seed = 91;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 300; ++i) {
    TEST_INFO("case", i);
    StopRamp ramp;
    const StopLimits limits{random.integer(1, kMotionLimit >> random.integer(1, 61)),
                            random.integer(1, kMotionLimit >> random.integer(1, 61))};
    const auto any = [&random] { return static_cast<Signal>(random.next()); };
    ramp.start(limits, any(), any(), any());
    for (int tick = 0; tick < 50; ++tick) static_cast<void>(ramp.tick());
    ramp.start(made(1e30, 1e30), any(), any(), any());
    for (int tick = 0; tick < 4; ++tick) static_cast<void>(ramp.tick());
    TEST_ASSERT_TRUE(ramp.at_rest());
  }
}
