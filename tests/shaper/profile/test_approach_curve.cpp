// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/approach_curve.hpp"

#include "shaper/base/math.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

TEST(the_curve_is_a_stop_run_backwards) {
  // GIVEN a stop to rest whose braking is let go by one jerk a tick WHEN it is run backwards from its end
  // THEN the curve tells at every gap the velocity and braking that it had
  const uint64_t seed = 8;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 200; ++i) {
    TEST_INFO("case", i);
    const int64_t limit = INT64_C(1) << random.integer(4, 38);
    const int64_t jerk = (limit >> random.integer(0, 9)) + 3;
    const int64_t velocity = limit * random.integer(20, 2000);
    const ApproachCurve curve = ApproachCurve::make(velocity, limit, jerk);
    TEST_ASSERT_AT_MOST_INT64(limit - 1, curve.braking());
    TEST_ASSERT_AT_MOST_INT64(jerk / 2, curve.jerk());
    int64_t gap = 0;
    int64_t speed = 0;
    int64_t braking = curve.jerk();
    for (int tick = 0; speed < velocity && tick < 3000; ++tick) {
      const ApproachCurve::Point point = curve.at(gap);
      // a square root drops bits of the velocity: 2^-28 of the largest
      const double rounding = braking < curve.braking() ? 0.0 : 1.0 + static_cast<double>(4 * velocity) / 268435456.0;
      TEST_ASSERT_DOUBLE_WITHIN(rounding, static_cast<double>(speed), static_cast<double>(point.velocity));
      TEST_ASSERT_EQUAL_INT64(braking, point.braking);
      speed += braking;
      gap += speed;
      braking = braking + curve.jerk() < curve.braking() ? braking + curve.jerk() : curve.braking();
    }
  }
}

TEST(the_curve_rises_with_the_gap_and_asks_for_no_more_than_its_braking) {
  const ApproachCurve curve = ApproachCurve::make(1000000, 3000, 100);
  ApproachCurve::Point last = curve.at(0);
  TEST_ASSERT_EQUAL_INT64(0, last.velocity);
  for (int64_t gap = 1; gap < 2000000000; gap += 1 + gap / 64) {
    const ApproachCurve::Point point = curve.at(gap);
    TEST_ASSERT_AT_LEAST_INT64(last.velocity, point.velocity);
    TEST_ASSERT_AT_LEAST_INT64(last.braking, point.braking);
    TEST_ASSERT_AT_MOST_INT64(curve.braking(), point.braking);
    last = point;
  }
  TEST_ASSERT_AT_LEAST_INT64(2000000, curve.at(INT64_C(1) << 61).velocity);
}
