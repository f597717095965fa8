// SPDX-License-Identifier: Apache-2.0
#include "sim/least_ticks.hpp"

#include <cmath>
#include <complex>

#include "shaper/profile/plan.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::sim;

namespace {

constexpr double kTick = 1e-3;
const Mode kPaperMode{11.0, 0.11};

}  // namespace

// reference.md, 5, found by another programme.
TEST(the_four_reference_moves_need_what_the_reference_says) {
  struct Case {
    double distance;
    double jerk;
    uint32_t known;
    uint32_t least;
  };
  for (const Case& each :
       {Case{0.5, 400, 446, 405}, {0.1, 400, 246, 212}, {0.5, 4000, 401, 358}, {0.02, 400, 163, 135}}) {
    const LeastTicksQuestion question{each.distance, {2, 20, 20, each.jerk}, {kPaperMode}, kTick};
    TEST_ASSERT_EQUAL_UINT32(each.least, least_ticks(question, each.known).value());
    // And no fewer, however many are known to do.
    TEST_ASSERT_EQUAL_UINT32(each.least, least_ticks(question, each.known + 57).value());
  }
}

TEST(the_farthest_stream_keeps_its_limits_and_leaves_the_mode_still) {
  const LeastTicksQuestion question{0.1, {2, 20, 15, 400, 600}, {kPaperMode, {30.0, 0.0}}, kTick};
  std::vector<double> setpoints;
  const double distance = farthest(question, 230, &setpoints);
  TEST_ASSERT_EQUAL_UINT32(230, setpoints.size());
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, distance, setpoints.back());
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
  std::vector<std::complex<double>> states(question.modes.size());
  for (size_t i = 0; i < setpoints.size() + 3; ++i) {
    const double next = i < setpoints.size() ? setpoints[i] : setpoints.back();
    const double step = next - position;
    const double change = step - velocity;
    TEST_ASSERT_AT_MOST_DOUBLE(question.limits.velocity * kTick * (1.0 + 1e-6), std::abs(step));
    TEST_ASSERT_AT_MOST_DOUBLE(question.limits.acceleration * kTick * kTick * (1.0 + 1e-5), change);
    TEST_ASSERT_AT_MOST_DOUBLE(question.limits.deceleration * kTick * kTick * (1.0 + 1e-5), -change);
    TEST_ASSERT_AT_MOST_DOUBLE(600 * kTick * kTick * kTick * (1.0 + 1e-3), std::abs(change - acceleration));
    for (size_t m = 0; m < states.size() && i < setpoints.size(); ++m) {
      const double w = 2.0 * std::acos(-1.0) * question.modes[m].frequency_hz * kTick;
      const double z = question.modes[m].damping_ratio;
      states[m] = states[m] * std::exp(w * std::complex<double>(-z, std::sqrt(1.0 - z * z))) + step;
    }
    position = next;
    velocity = step;
    acceleration = change;
  }
  for (const std::complex<double>& state : states) TEST_ASSERT_AT_MOST_DOUBLE(1e-8 * distance, std::abs(state));
}

// Without a mode what is left is the plain move, and the optimum of its continuous time is as long, less the ticks in
// which the differences of the samples come after the samples.
TEST(without_a_mode_the_plain_s_curve_is_the_least_but_for_its_last_ticks) {
  for (const double distance : {0.02, 0.1, 0.5}) {
    const AxisLimits limits{2, 20, 12, 400};
    Plan plan{};
    TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, ProfileKind::kSCurve, kTick, plan));
    const uint32_t least = least_ticks({distance, limits, {}, kTick}, plan.duration_ticks).value();
    TEST_ASSERT_AT_MOST_INT64(plan.duration_ticks, least);
    TEST_ASSERT_AT_LEAST_INT64(int64_t{plan.duration_ticks} - 3, least);
  }
}

TEST(a_move_that_is_too_long_to_be_asked_about_is_left_unanswered) {
  const LeastTicksQuestion question{0.5, {2, 20, 20, 400}, {kPaperMode}, kTick};
  TEST_ASSERT_FALSE(least_ticks(question, kMostLeastTicks + 1).has_value());
}
