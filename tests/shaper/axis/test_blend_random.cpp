// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/math.hpp"
#include "tests/shaper/axis/retuning.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

ShaperDesign random_shaper(Random& random, const ShaperDesign& now) {
  const ShaperDesign fast = zv(37.0), slow = three_hump_ei(30.0, kTick);
  switch (random.integer(0, 5)) {
    case 0: return ShaperDesign{};
    case 1: {
      const double frequency_hz = random.between(5.0, 200.0);
      return zv(frequency_hz, random.between(0.0, 0.2));
    }
    case 2: return three_hump_ei(random.between(20.0, 200.0), kTick);
    default: return same(now, fast) ? slow : fast;
  }
}

AxisLimits random_limits(Random& random) {
  const double velocity = random.between(0.1e6, 2e6);
  return {velocity, velocity * random.between(5.0, 50.0), velocity * random.between(5.0, 50.0),
          velocity * math::exp(random.between(5.0, 10.0))};
}

}  // namespace

TEST_HOST_F(Retuning, ten_thousand_changes_at_random_times_in_random_moves_keep_every_promise) {
  const uint64_t seed = 20261124;
  TEST_INFO("seed", seed);
  Random random(seed);
  int blended = 0;
  int32_t position = 0;
  for (int i = 0; i < 10000; ++i) {
    TEST_INFO("case", i);
    start_with(axis.shaper(), random_shaper(random, axis.shaper()));
    const AxisLimits limits = random_limits(random);
    const bool trapezoid = random.integer(0, 9) == 0;
    const bool zero_delay = random.integer(0, 9) == 0;
    const double reach = limits.velocity * math::exp(random.between(-4.0, 1.0));
    int32_t target = position + static_cast<int32_t>(random.between(-reach, reach));
    if (target > 100000000 || target < -100000000) target = 0;
    Move move{target, trapezoid ? ProfileKind::kTrapezoid : ProfileKind::kSCurve, limits, 0.0, zero_delay};
    MoveReport report{};
    TEST_ASSERT_OK(axis.command(move, &report));
    if (random.integer(0, 2) != 0 && !zero_delay) {
      // The same more slowly: its first tick has not come, so drop it and ask again.
      axis.request_stop();
      axis.tick();
      move.duration_s = report.profile_ticks * kTick * random.between(1.0, 1.5) + kTick;
      TEST_ASSERT_OK(axis.command(move, &report));
    }
    const auto at = static_cast<uint32_t>(random.integer(1, report.total_ticks < 2 ? 1 : report.total_ticks - 1));
    run(target, at, limits, random.integer(0, 3) != 0, !trapezoid);
    position = target;
    if (in_motion) ++blended;
  }
  MESSAGE("blended before rest: ", blended,
          " of 10000; worst excess over velocity, acceleration, jerk, LSB: ", worst[0], " ", worst[1], " ", worst[2]);
}
