// SPDX-License-Identifier: Apache-2.0
// Streams that keep the limits pass the limiter bit for bit.
#include "shaper/profile/plan_from.hpp"
#include "shaper/profile/track.hpp"
#include "shaper/shaping/design.hpp"
#include "shaper/shaping/shaper.hpp"
#include "tests/shaper/profile/limited_stream_rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

AxisLimits scaled(const AxisLimits& limits, double factor) {
  return AxisLimits{limits.velocity * factor, limits.acceleration * factor, limits.deceleration * factor,
                    limits.jerk * factor};
}

}  // namespace

TEST(moves_of_all_sizes_pass_bit_for_bit) {
  const uint64_t seed = 301;
  TEST_INFO("seed", seed);
  Random random(seed);
  long ticks = 0;
  for (int i = 0; i < 1500; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 0.7);
    Stream stream(limits, StreamPolicy::kFault);
    Plan plan{};
    const double reach = std::fmin(limits.velocity * decades(random, -4.0, 0.5), 1e9);
    const auto distance = static_cast<int32_t>(random.between(-reach, reach));
    TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, ProfileKind::kSCurve, kTick, plan));
    if (distance == 0 || plan.duration_ticks > 5000) continue;
    Track track{};
    Track::make(plan, 0, signal_from_counts(distance), track);
    Sampler sampler;
    for (sampler.begin(track); !sampler.at_rest(); ++ticks) stream.pass(sampler.tick());
    for (int tick = 0; tick < 3; ++tick) stream.pass(sampler.position());
  }
  TEST_ASSERT_AT_LEAST_INT64(300000, ticks);
}

TEST(moves_that_are_planned_anew_on_the_way_and_turn_round_pass_bit_for_bit) {
  const uint64_t seed = 302;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 1000; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 0.7);
    // a plan from a motion begins with what its doubles make of it
    Stream stream(scaled(limits, 1.0 + 1e-12), StreamPolicy::kFault);
    Differences state = standing(0);
    for (int leg = 0; leg < 6; ++leg) {
      const double reach = std::fmin(limits.velocity * decades(random, -2.0, 0.0), 1e8);
      const Signal target = signal_from_counts(static_cast<int32_t>(random.between(-reach, reach)));
      const double distance = static_cast<double>(target - signal_of(state)) / kLsb;
      Plan plan{};
      if (!plan_from(motion_of(state, kTick), distance, limits, kTick, plan).ok() || plan.duration_ticks > 3000) break;
      Track track{};
      Track::make_from(plan, state, target, track);
      const auto until = leg == 5 ? plan.duration_ticks : static_cast<uint32_t>(random.integer(0, plan.duration_ticks));
      uint32_t unused = 0;
      for (uint32_t tick = 1; tick <= until; ++tick) stream.pass(signal_of(track.differences_at(tick, unused)));
      state = track.differences_at(until, unused);
    }
  }
}

TEST(sines_within_the_limits_pass_bit_for_bit) {
  const uint64_t seed = 303;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 300; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 0.7);
    const double omega = decades(random, 0.0, 2.5);  // 1/s
    const double softer = std::fmin(limits.acceleration, limits.deceleration);
    const double amplitude =
        std::fmin(std::fmin(limits.velocity / omega, softer / (omega * omega)), limits.jerk / (omega * omega * omega));
    // GIVEN a stream that begins on the sine, in motion
    const auto at = [&](int tick) {
      return static_cast<Signal>(std::llround(static_cast<long double>(amplitude) * 4294967296.0L *
                                              std::sin(static_cast<long double>(omega) * 1e-3L * tick)));
    };
    StreamLimiter limiter;
    limiter.start(made(limits), StreamPolicy::kFault, 0, at(0), at(-1), at(-2));
    for (int tick = 1; tick < 3000; ++tick) TEST_ASSERT_EQUAL_INT64(at(tick), limiter.tick(at(tick)));
  }
}

TEST(shaped_streams_pass_bit_for_bit) {
  const uint64_t seed = 304;
  TEST_INFO("seed", seed);
  Random random(seed);
  constexpr ShaperKind kKinds[] = {ShaperKind::kZv, ShaperKind::kZvd, ShaperKind::kEi, ShaperKind::kCv2};
  for (int i = 0; i < 300; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 0.0);
    ShaperDesign design{};
    const Mode mode{random.between(5.0, 50.0), random.between(0.0, 0.2)};
    TEST_ASSERT_OK(add_shaper(kKinds[random.integer(0, 3)], mode, kTick, design));
    static LineSample memory[2048];
    Shaper shaper;
    TEST_ASSERT_OK(shaper.configure(design, memory, 2048, 0));
    // each stage rounds anew, which the limits have to have room for
    Stream stream(scaled(limits, 1.0 + 1e-5), StreamPolicy::kFault);
    Plan plan{};
    const auto distance = static_cast<int32_t>(std::fmin(limits.velocity * random.between(0.0, 1.0), 1e9));
    TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, ProfileKind::kSCurve, kTick, plan));
    if (plan.duration_ticks > 5000) continue;
    Track track{};
    Track::make(plan, 0, signal_from_counts(distance), track);
    Sampler sampler;
    sampler.begin(track);
    for (uint32_t tick = 0; tick < plan.duration_ticks + shaper.length_ticks() + 2; ++tick)
      stream.pass(shaper.tick(sampler.tick()));
  }
}
