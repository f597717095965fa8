// SPDX-License-Identifier: Apache-2.0
#include "sim/retuned_stream.hpp"

#include <algorithm>

#include "shaper/base/math.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/profile/track.hpp"
#include "tests/support/shapers.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;
using stillpoint::testing::StreamCheck;
using stillpoint::testing::three_hump_ei;

namespace {

constexpr double kTick = 1e-3;

ShaperDesign zv_37_hz() {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{37.0, 0.0}, kTick, design));
  return design;
}

std::vector<Signal> move(int32_t target, const AxisLimits& limits, double slower = 1.0) {
  Plan plan{};
  TEST_ASSERT_OK(plan_rest_to_rest(target, limits, ProfileKind::kSCurve, kTick, plan));
  TEST_ASSERT_OK(stretch(plan, static_cast<uint32_t>(plan.duration_ticks * slower)));
  Track track{};
  Track::make(plan, 0, signal_from_counts(target), track);
  Sampler sampler;
  sampler.begin(track);
  std::vector<Signal> stream;
  while (!sampler.at_rest()) stream.push_back(sampler.tick());
  return stream;
}

struct Random37And30 {
  const ShaperDesign fast = zv_37_hz();
  const ShaperDesign slow = three_hump_ei(30.0, kTick);
};

// The largest magnitudes of the first three differences.
struct Peaks {
  double of[3] = {};

  explicit Peaks(const std::vector<Signal>& stream) {
    Signal last = 0;
    int64_t velocity = 0, acceleration = 0;
    for (const Signal signal : stream) {
      const int64_t step = signal - last;
      const int64_t change = step - velocity;
      const double all[] = {static_cast<double>(step), static_cast<double>(change),
                            static_cast<double>(change - acceleration)};
      for (int i = 0; i < 3; ++i) of[i] = std::max(of[i], std::abs(all[i]));
      last = signal;
      velocity = step;
      acceleration = change;
    }
  }
};

}  // namespace

TEST_HOST_F(Random37And30, a_cruise_is_blended_each_way) {
  const AxisLimits limits{1.2e6, 20e6, 20e6, 600e6};
  const std::vector<Signal> input = move(1700000, limits, 1.2);
  for (int way = 0; way < 2; ++way) {
    TEST_INFO("way", way);
    const ShaperDesign& from = way == 0 ? fast : slow;
    const ShaperDesign& to = way == 0 ? slow : fast;
    const sim::RetunedStream stream = sim::retuned(input, from, {{400, to}}, limits, kTick);
    const sim::RetunedStream before = sim::retuned(input, from, {}, limits, kTick);
    const sim::RetunedStream after = sim::retuned(input, to, {}, limits, kTick);
    REQUIRE(stream.active_from.size() == 1);
    TEST_ASSERT_AT_MOST_INT64(930, stream.active_from[0]);
    TEST_ASSERT_EQUAL_UINT64(after.output.size(), stream.output.size());
    for (size_t i = 0; i <= 400; ++i) TEST_ASSERT_EQUAL_INT64(before.output[i], stream.output[i]);
    for (size_t i = stream.active_from[0]; i < stream.output.size(); ++i)
      TEST_ASSERT_EQUAL_INT64(after.output[i], stream.output[i]);
  }
}

TEST_HOST_F(Random37And30, random_moves_keep_their_limits_and_arrive) {
  const uint64_t seed = 37;
  TEST_INFO("seed", seed);
  Random random(seed);
  int blended = 0;
  for (int i = 0; i < 400; ++i) {
    TEST_INFO("case", i);
    const double velocity = random.between(0.1e6, 2e6);
    const AxisLimits limits{velocity, velocity * random.between(5.0, 50.0), velocity * random.between(5.0, 50.0),
                            velocity * math::exp(random.between(5.0, 9.0))};
    const auto target = static_cast<int32_t>(random.between(-velocity, velocity));
    std::vector<Signal> input = move(target, limits, random.between(1.0, 1.4));
    const bool whole = i % 2 == 0;
    if (whole) {
      for (Signal& signal : input) signal = signal_from_counts(counts_from_signal(signal));
    }
    const ShaperDesign& from = random.integer(0, 1) == 0 ? fast : slow;
    const ShaperDesign& to = &from == &fast ? slow : fast;
    const auto at = static_cast<size_t>(random.integer(0, static_cast<int64_t>(input.size()) - 1));
    const sim::RetunedStream stream = sim::retuned(input, from, {{at, to}}, limits, kTick);
    REQUIRE(stream.active_from.size() == 1);
    const std::vector<Signal> before = sim::retuned(input, from, {}, limits, kTick).output;
    const std::vector<Signal> after = sim::retuned(input, to, {}, limits, kTick).output;
    TEST_ASSERT_AT_MOST_INT64(before.size(), stream.active_from[0]);
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(target), stream.output.back());
    if (stream.active_from[0] < before.size()) ++blended;
    if (whole) {
      const Peaks own(stream.output), old_peaks(before), new_peaks(after);
      const double kept[] = {limits.velocity * kTick, std::max(limits.acceleration, limits.deceleration) * 1e-6,
                             limits.jerk * 1e-9};
      for (int k = 0; k < 3; ++k) {
        const double bound = std::max({kept[k] * 4294967296.0, old_peaks.of[k], new_peaks.of[k]});
        TEST_ASSERT_AT_MOST_DOUBLE(bound + 4 * (1 << k), own.of[k]);
      }
    } else {
      StreamCheck check(0, target >= 0, limits, kTick);
      for (const Signal signal : stream.output) check.next(signal);
      TEST_ASSERT_TRUE(check.within(3));
    }
  }
  MESSAGE("blended before rest: ", blended, " of 400");
}

TEST_HOST_F(Random37And30, several_retunes_follow_each_other) {
  const AxisLimits limits{1.2e6, 20e6, 20e6, 600e6};
  std::vector<Signal> input = move(1700000, limits, 1.5);
  input.insert(input.end(), 300, input.back());
  const sim::RetunedStream stream =
      sim::retuned(input, fast, {{200, slow}, {210, fast}, {2400, ShaperDesign{}}, {99999, fast}}, limits, kTick);
  REQUIRE(stream.active_from.size() == 3);
  TEST_ASSERT_TRUE(stream.active_from[0] < stream.active_from[1]);
  TEST_ASSERT_TRUE(stream.active_from[1] < 2000);
  TEST_ASSERT_EQUAL_UINT64(2400, stream.active_from[2]);
  TEST_ASSERT_EQUAL_INT64(input.back(), stream.output.back());
  StreamCheck check(0, true, limits, kTick);
  for (const Signal signal : stream.output) check.next(signal);
  TEST_ASSERT_TRUE(check.within(3));
}

TEST_HOST_F(Random37And30, an_empty_or_standing_stream_stands) {
  const AxisLimits limits{1e6, 1e7, 1e7, 1e9};
  REQUIRE(sim::retuned({}, fast, {{0, slow}}, limits, kTick).output.empty());
  const std::vector<Signal> zeros(10, 0);
  const sim::RetunedStream stream = sim::retuned(zeros, fast, {{3, slow}, {9, fast}, {10, slow}}, limits, kTick);
  REQUIRE(stream.output == zeros);
  REQUIRE(stream.active_from == std::vector<size_t>{3, 9});
}
