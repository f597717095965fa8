// SPDX-License-Identifier: Apache-2.0
// A scope's record told to the tuner is the record that the tuner identifies from.
#include "sim/recorded_rest.hpp"

#include "shaper/axis/axis.hpp"
#include "shaper/identify/capture.hpp"
#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kScope = 2048;

std::vector<int32_t> random_samples(Random& random, size_t count) {
  std::vector<int32_t> samples;
  for (size_t n = 0; n < count; ++n) samples.push_back(static_cast<int32_t>(random.integer(-1000000, 1000000)));
  return samples;
}

TEST(a_sample_stands_for_its_ticks_and_the_last_one_for_all_that_come) {
  const sim::RestChannel channel{{5, -3, 8}, 4};
  const int32_t expected[] = {5, 5, 5, 5, -3, -3, -3, -3, 8, 8, 8, 8, 8, 8};
  for (uint32_t tick = 0; tick < 14; ++tick) TEST_ASSERT_EQUAL_INT64(expected[tick], channel.at(tick));
  TEST_ASSERT_EQUAL_UINT64(12, channel.ticks());
  TEST_ASSERT_EQUAL_INT64(0, sim::RestChannel{}.at(7));
}

TEST(the_motor_stands_where_the_following_error_says) {
  sim::RecordedRest rest;
  rest.following_error = {{2, -7}, 1};
  rest.acceleration = {{11, 12, 13}, 2};
  const Signal setpoint = 1000 * kSignalPerCount + 5;
  const TuneSample first = rest.at(0, setpoint);
  TEST_ASSERT_EQUAL_INT64(setpoint - 2 * kSignalPerCount, first.position);
  TEST_ASSERT_EQUAL_INT64(setpoint, first.setpoint);
  TEST_ASSERT_EQUAL_INT64(11, first.acceleration);
  TEST_ASSERT_TRUE(first.fresh);
  const TuneSample later = rest.at(3, setpoint);
  TEST_ASSERT_EQUAL_INT64(setpoint + 7 * kSignalPerCount, later.position);
  TEST_ASSERT_EQUAL_INT64(12, later.acceleration);
  TEST_ASSERT_EQUAL_UINT64(6, rest.ticks());
}

TEST(a_sensor_that_reads_one_value_is_none) {
  TEST_ASSERT_FALSE(sim::changes({}));
  TEST_ASSERT_FALSE(sim::changes({-981, -981, -981}));
  TEST_ASSERT_TRUE(sim::changes({-981, -981, -980}));
}

// What AutoTune's capture takes of it, means over the decimation, is the scope's samples again, from where its watch
// finds the rest; and however late that is there are enough.
TEST(the_record_that_is_captured_from_it_is_the_scopes) {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    TEST_INFO("seed", seed);
    Random random(seed);
    const double high_hz = random.between(20.0, 200.0);
    const double low_hz = random.between(1.0, 10.0);
    ListenPlan listen{};
    const uint32_t samples = sim::samples_for_tuning(kScope);
    TEST_ASSERT_OK(plan_listening(low_hz, high_hz, 1e-3, samples, listen));
    sim::RecordedRest rest;
    rest.following_error = {std::vector<int32_t>(512, 3), 1};
    // The motor creeps in, or does not come to rest at all.
    const bool creeps = random.integer(0, 3) != 0;
    const auto rests_at = static_cast<size_t>(random.integer(0, 200));
    for (size_t n = 0; n < 512; ++n) {
      if (!creeps || n < rests_at) rest.following_error.samples[n] = n % 2 == 0 ? 500 : -500;
    }
    rest.acceleration = {random_samples(random, kScope), listen.decimation};
    CaptureConfig config;
    config.samples = listen.samples;
    config.pre_trigger = listen.pre_trigger;
    config.decimation = listen.decimation;
    config.mean = true;
    std::vector<CaptureWord> memory(listen.samples);
    Capture capture{};
    TEST_ASSERT_OK(capture.start(config, memory.data(), memory.size()));
    RestWatch watch{};
    watch.arm(10 * kSignalPerCount, listen.window_ticks, listen.patience_ticks);
    TEST_ASSERT_FALSE(watch.tick(false, 0, true));
    uint32_t tick = 0;
    for (; capture.state() != CaptureState::kFull && tick < 200000; ++tick) {
      const TuneSample sample = rest.at(tick, 0);
      if (watch.tick(true, sample.position, sample.fresh)) capture.trigger();
      capture.tick(&sample.acceleration, sample.fresh);
    }
    TEST_ASSERT_AT_LEAST_INT64(tick, static_cast<int64_t>(rest.acceleration.ticks()));
    const size_t first = tick / listen.decimation - listen.samples;
    for (uint32_t n = 0; n < listen.samples; ++n)
      TEST_ASSERT_EQUAL_INT64(rest.acceleration.samples[first + n], capture.value(0, n));
    const size_t stands = creeps ? rests_at : listen.patience_ticks;
    TEST_ASSERT_AT_LEAST_INT64(static_cast<int64_t>(stands), static_cast<int64_t>(first * listen.decimation));
  }
}

}  // namespace
