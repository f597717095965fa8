// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/stream_limiter.hpp"

#include "shaper/profile/track.hpp"
#include "tests/shaper/profile/limited_stream.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::LimitedStream;
using stillpoint::testing::Random;

namespace {

constexpr double kTick = 1e-3;
constexpr AxisLimits kLimits{1.2e6, 20e6, 30e6, 600e6};

StreamLimits made(const AxisLimits& limits) {
  StreamLimits made{};
  TEST_ASSERT_OK(StreamLimits::make(limits, kTick, made));
  return made;
}

// A limiter that stands at zero.
struct Standing {
  StreamLimits limits = made(kLimits);
  StreamLimiter limiter = {};
  LimitedStream watch = LimitedStream(kLimits, kTick);

  Standing() { start(StreamPolicy::kClamp); }

  void start(StreamPolicy policy, uint32_t made_up_ticks = 0) { limiter.start(limits, policy, made_up_ticks, 0, 0, 0); }

  Signal step(Signal input) {
    const uint32_t before = limiter.limited_ticks();
    const Signal output = limiter.tick(input);
    watch.next(output);
    TEST_ASSERT_EQUAL_INT64(output, limiter.position());
    TEST_ASSERT_TRUE(limiter.limiting() == (output != input));
    TEST_ASSERT_EQUAL_UINT32(before + (output != input ? 1 : 0), limiter.limited_ticks());
    return output;
  }

  // Until the output is the input for good; the input moves at `velocity`.
  uint32_t ticks_to_reach(Signal& input, int64_t velocity, uint32_t give_up) {
    uint32_t ticks = 0;
    do {
      input = wrapping_sum(input, velocity);
      step(input);
      TEST_ASSERT_AT_MOST_INT64(give_up, ++ticks);
    } while (limiter.limiting());
    for (int i = 0; i < 20; ++i) {
      input = wrapping_sum(input, velocity);
      TEST_ASSERT_EQUAL_INT64(input, step(input));
    }
    return ticks;
  }
};

Sampler sampler_of(const AxisLimits& limits, int32_t distance, Track& track) {
  Plan plan{};
  TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, ProfileKind::kSCurve, kTick, plan));
  Track::make(plan, 0, signal_from_counts(distance), track);
  Sampler sampler;
  sampler.begin(track);
  return sampler;
}

}  // namespace

TEST_F(Standing, a_move_within_the_limits_passes_bit_for_bit) {
  start(StreamPolicy::kFault);
  Track track{};
  Sampler sampler = sampler_of(kLimits, 1700000, track);
  while (!sampler.at_rest()) {
    const Signal input = sampler.tick();
    TEST_ASSERT_EQUAL_INT64(input, step(input));
  }
  TEST_ASSERT_EQUAL_UINT32(0, limiter.limited_ticks());
  TEST_ASSERT_FALSE(limiter.faulted());
}

TEST_F(Standing, a_step_is_followed_within_the_limits_without_passing_it) {
  // 1000 counts: the optimum takes 4 (d / 2j)^(1/3) = 38 ticks
  Signal input = signal_from_counts(1000);
  Signal highest = 0;
  uint32_t ticks = 0;
  do {
    const Signal output = step(input);
    if (output > highest) highest = output;
    TEST_ASSERT_AT_MOST_INT64(60, ++ticks);
  } while (limiter.limiting());
  TEST_ASSERT_AT_LEAST_INT64(36, ticks);
  TEST_ASSERT_EQUAL_INT64(input, highest);
  TEST_ASSERT_EQUAL_UINT32(ticks - 1, limiter.limited_ticks());
  TEST_ASSERT_EQUAL_INT64(input, step(input));
}

TEST_F(Standing, a_velocity_step_is_caught_up_with) {
  Signal input = 0;
  // v/a + a/j = 58 ticks to the velocity, and some more to make up what was lost
  const uint32_t ticks = ticks_to_reach(input, signal_from_counts(500), 200);
  TEST_ASSERT_AT_LEAST_INT64(58, ticks);
}

TEST_F(Standing, whole_counts_are_smoothed_without_falling_behind) {
  // GIVEN a stream rounded to counts, whose third difference of up to 4 counts is far above the jerk of 0.6 a tick
  const AxisLimits slower{0.3 * kLimits.velocity, 0.3 * kLimits.acceleration, 0.3 * kLimits.deceleration,
                          0.3 * kLimits.jerk};
  Track track{};
  Sampler sampler = sampler_of(slower, 700000, track);
  int64_t farthest = 0;
  while (!sampler.at_rest()) {
    const Signal input = signal_from_counts(counts_from_signal(sampler.tick()));
    const Signal off = step(input) - input;
    const int64_t distance = off < 0 ? -off : off;
    if (distance > farthest) farthest = distance;
  }
  // THEN the output is off by a fraction of a tick's 360 counts, at times only, and ends on the target
  TEST_ASSERT_AT_MOST_INT64(signal_from_counts(40), farthest);
  TEST_ASSERT_AT_MOST_INT64(track.duration_ticks / 3, limiter.limited_ticks());
  TEST_ASSERT_AT_LEAST_INT64(1, limiter.limited_ticks());
  Signal input = signal_from_counts(700000);
  ticks_to_reach(input, 0, 30);
}

TEST_F(Standing, a_tick_over_the_jerk_limit_delays_by_that_only) {
  // WHEN the acceleration of a stream begins at once rather than in 33 ticks THEN the output lags, and catches up
  Signal input = 0;
  int64_t velocity = 0;
  for (int tick = 0; tick < 40; ++tick) {
    velocity += signal_from_counts(18);
    input += velocity;
    step(input);
  }
  TEST_ASSERT_TRUE(limiter.limiting());
  ticks_to_reach(input, velocity, 200);
}

TEST_F(Standing, the_first_tick_that_breaks_a_limit_faults_if_it_is_to) {
  start(StreamPolicy::kFault);
  Track track{};
  Sampler sampler = sampler_of(kLimits, 1700000, track);
  for (int tick = 0; tick < 500; ++tick) step(sampler.tick());
  TEST_ASSERT_FALSE(limiter.faulted());
  // GIVEN a master that jumps WHEN it goes on as if nothing were THEN the output has stopped for good
  step(sampler.tick() + signal_from_counts(50));
  TEST_ASSERT_TRUE(limiter.faulted());
  uint32_t ticks = 1;
  while (!limiter.at_rest()) {
    step(sampler.tick());
    TEST_ASSERT_AT_MOST_INT64(90, ++ticks);  // v/a + a/j: 40 + 50
  }
  const Signal stand = limiter.position();
  for (int tick = 0; tick < 20; ++tick) TEST_ASSERT_EQUAL_INT64(stand, step(sampler.tick()));
  TEST_ASSERT_TRUE(limiter.faulted());
  // and a new start clears it
  const uint32_t limited = limiter.limited_ticks();
  limiter.start(limits, StreamPolicy::kFault, 0, stand, stand, stand);
  TEST_ASSERT_FALSE(limiter.faulted());
  TEST_ASSERT_EQUAL_INT64(stand + 1, step(stand + 1));
  TEST_ASSERT_EQUAL_UINT32(limited, limiter.limited_ticks());
}

TEST_F(Standing, an_input_that_does_not_come_is_made_up_for_as_long_as_allowed) {
  start(StreamPolicy::kFault, 2);
  Signal input = 0;
  const int64_t velocity = limits.jerk / 2;
  for (int tick = 0; tick < 300; ++tick) {
    input += velocity;
    const bool lost = tick % 10 == 4 || tick % 10 == 5;
    watch.next(lost ? limiter.tick() : limiter.tick(input));
    TEST_ASSERT_EQUAL_INT64(input, limiter.position());
  }
  TEST_ASSERT_EQUAL_UINT32(0, limiter.limited_ticks());
  TEST_ASSERT_FALSE(limiter.faulted());
}

TEST_F(Standing, a_master_that_falls_silent_in_motion_stops_the_axis_where_it_was_last_known_to_be) {
  start(StreamPolicy::kClamp, 2);
  Signal input = 0;
  ticks_to_reach(input, signal_from_counts(500), 200);
  const Signal last = input + 2 * signal_from_counts(500);
  for (int tick = 0; tick < 400; ++tick) watch.next(limiter.tick());
  TEST_ASSERT_EQUAL_INT64(last, limiter.position());
  TEST_ASSERT_TRUE(limiter.at_rest());
  TEST_ASSERT_FALSE(limiter.limiting());
}

TEST_F(Standing, the_way_to_the_input_is_the_shorter_one_and_may_wrap) {
  const Signal from = INT64_MAX - signal_from_counts(10);
  limiter.start(limits, StreamPolicy::kClamp, 0, from, from, from);
  watch = LimitedStream(kLimits, kTick, from);
  Signal input = INT64_MIN + signal_from_counts(100);
  TEST_ASSERT_AT_MOST_INT64(60, ticks_to_reach(input, 0, 60));
}

TEST_F(Standing, from_outside_its_limits_it_comes_back_by_the_jerk) {
  const int64_t velocity = limits.velocity * 3;
  limiter.start(limits, StreamPolicy::kClamp, 0, 0, -velocity, -2 * velocity);
  Signal last = 0;
  int64_t speed = velocity;
  int64_t acceleration = 0;
  for (int tick = 0; tick < 200; ++tick) {
    const Signal next = limiter.tick(0);
    TEST_ASSERT_AT_MOST_INT64(limits.jerk, acceleration - (next - last - speed));
    TEST_ASSERT_AT_LEAST_INT64(-limits.jerk, acceleration - (next - last - speed));
    acceleration = next - last - speed;
    TEST_ASSERT_AT_LEAST_INT64(-limits.deceleration, acceleration);
    speed = next - last;
    last = next;
  }
  TEST_ASSERT_AT_MOST_INT64(limits.velocity, speed);
  Signal input = 0;
  watch = LimitedStream(kLimits, kTick, last, speed, acceleration);
  ticks_to_reach(input, 0, 2000);
}

TEST_F(Standing, a_stream_shifted_by_half_the_range_gives_the_same_output_shifted) {
  const uint64_t seed = 12;
  TEST_INFO("seed", seed);
  Random random(seed);
  StreamLimiter other;
  other.start(limits, StreamPolicy::kClamp, 0, INT64_MIN, INT64_MIN, INT64_MIN);
  Signal input = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    if (tick % 50 == 0) input = signal_from_counts(static_cast<int32_t>(random.integer(-3000, 3000)));
    const Signal expected = wrapping_sum(INT64_MIN, step(input));
    TEST_ASSERT_EQUAL_INT64(expected, other.tick(wrapping_sum(INT64_MIN, input)));
  }
}

TEST(bad_stream_limits_are_refused_by_name_and_change_nothing) {
  StreamLimits limits = made(kLimits);
  const int64_t velocity = limits.velocity;
  const auto make = [&limits](const AxisLimits& from, double tick_s) {
    return StreamLimits::make(from, tick_s, limits);
  };
  TEST_ASSERT_REFUSED(kNotFinite, kVelocity, make(AxisLimits{__builtin_inf(), 1, 1, 1}, kTick));
  TEST_ASSERT_REFUSED(kNotPositive, kJerk, make(AxisLimits{1, 1, 1, 0}, kTick));
  TEST_ASSERT_REFUSED(kNotPositive, kTick, make(kLimits, -1.0));
  TEST_ASSERT_REFUSED(kNotFinite, kTick, make(kLimits, __builtin_nan("")));
  TEST_ASSERT_REFUSED(kBelowMinimum, kVelocity, make(AxisLimits{1e-9, 1, 1, 1}, kTick));
  TEST_ASSERT_REFUSED(kBelowMinimum, kAcceleration, make(AxisLimits{1, 1e-9, 1, 1}, kTick));
  TEST_ASSERT_REFUSED(kBelowMinimum, kDeceleration, make(AxisLimits{1, 1, 1e-9, 1}, kTick));
  TEST_ASSERT_REFUSED(kBelowMinimum, kJerk, make(AxisLimits{1, 1, 1, 1e-3}, kTick));
  TEST_ASSERT_EQUAL_INT64(velocity, limits.velocity);
}

TEST(limits_without_measure_limit_as_little_as_the_range_does) {
  const StreamLimits limits = made(AxisLimits{1e300, 1e300, 1e300, 1e300});
  TEST_ASSERT_EQUAL_INT64(ApproachCurve::kMaxVelocity, limits.velocity);
  StreamLimiter limiter;
  limiter.start(limits, StreamPolicy::kClamp, 0, 0, 0, 0);
  TEST_ASSERT_EQUAL_INT64(INT64_C(1) << 56, limiter.tick(INT64_C(1) << 56));
  TEST_ASSERT_EQUAL_INT64(0, limiter.tick(0));
  static_cast<void>(limiter.tick(INT64_MAX));
  for (int tick = 0; tick < 200 && limiter.limiting(); ++tick) static_cast<void>(limiter.tick(INT64_MAX));
  TEST_ASSERT_EQUAL_INT64(INT64_MAX, limiter.position());
}
