// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/still_plan.hpp"

#include <cmath>
#include <complex>
#include <vector>

#include "shaper/profile/track.hpp"
#include "tests/support/random_task.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;
using stillpoint::testing::StreamCheck;

namespace {

constexpr double kTick = 1e-3;

// The setpoints of a plan in counts.
std::vector<Signal> sampled(const Plan& plan, int32_t target_counts) {
  Track track{};
  Track::make(plan, 0, signal_from_counts(target_counts), track);
  Sampler sampler;
  sampler.begin(track);
  std::vector<Signal> setpoints;
  for (uint32_t i = 0; i < plan.duration_ticks; ++i) setpoints.push_back(sampler.tick());
  return setpoints;
}

// How far a mode is from rest after the last setpoint, over how far from it it came on the way: the oscillator's own
// recursion over the ticks, driven by the setpoints' steps.
double left_over(const std::vector<Signal>& setpoints, const Mode& mode) {
  const double w = 2.0 * std::acos(-1.0) * mode.frequency_hz * kTick;
  const std::complex<double> pole =
      std::exp(w * std::complex<double>(-mode.damping_ratio, std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio)));
  std::complex<double> state = 0.0;
  double largest = 0.0;
  Signal last = 0;
  for (const Signal setpoint : setpoints) {
    state = pole * state + static_cast<double>(setpoint - last);
    largest = std::max(largest, std::abs(state));
    last = setpoint;
  }
  return std::abs(state) / largest;
}

void check_stream(const std::vector<Signal>& setpoints, int32_t target_counts, const AxisLimits& limits) {
  StreamCheck check(0, target_counts > 0, limits, kTick);
  for (const Signal setpoint : setpoints) check.next(setpoint);
  for (int i = 0; i < 4; ++i) check.next(setpoints.back());
  TEST_ASSERT_TRUE(check.within(0));
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(target_counts), setpoints.back());
}

}  // namespace

// reference.md, 5: what any command needs, and what this one reached on 25 November 2026. Both sides: sooner than any
// command would be a mistake too.
TEST(the_four_reference_moves_are_within_two_percent_of_what_any_command_needs) {
  struct Case {
    double distance;
    double jerk;
    uint32_t least;
    uint32_t reached;
  };
  const Mode mode{11.0, 0.11};
  for (const Case& each :
       {Case{0.5, 400, 405, 407}, {0.1, 400, 212, 214}, {0.5, 4000, 358, 360}, {0.02, 400, 135, 137}}) {
    TEST_INFO("least", each.least);
    const AxisLimits limits{2e6, 20e6, 20e6, each.jerk * 1e6};
    const int32_t counts = static_cast<int32_t>(each.distance * 1e6);
    Plan plan{};
    TEST_ASSERT_OK(plan_still(counts, limits, &mode, 1, kTick, plan));
    TEST_ASSERT_AT_LEAST_INT64(each.least, plan.duration_ticks);
    TEST_ASSERT_AT_MOST_INT64(each.reached, plan.duration_ticks);
    const std::vector<Signal> setpoints = sampled(plan, counts);
    check_stream(setpoints, counts, limits);
    TEST_ASSERT_AT_MOST_DOUBLE(1e-8, left_over(setpoints, mode));
  }
}

TEST(random_moves_keep_their_limits_and_leave_the_mode_still) {
  const uint64_t seed = 11;
  TEST_INFO("seed", seed);
  Random random(seed);
  int planned = 0;
  constexpr int kMoves = 200;
  for (int i = 0; i < kMoves; ++i) {
    TEST_INFO("case", i);
    const testing::RandomTask task = testing::random_task(random);
    AxisLimits limits = task.limits;
    if (i % 4 == 3) limits.deceleration_jerk = limits.jerk * random.between(0.3, 3.0);
    Plan plain{};
    TEST_ASSERT_OK(plan_rest_to_rest(task.distance_counts, task.limits, ProfileKind::kSCurve, kTick, plain));
    Plan plan{};
    const Status status = plan_still(task.distance_counts, limits, &task.mode, 1, kTick, plan);
    if (!status.ok()) {
      TEST_ASSERT_REFUSED(kNotAvailable, kFrequency, status);
      continue;
    }
    ++planned;
    const std::vector<Signal> setpoints = sampled(plan, task.distance_counts);
    check_stream(setpoints, task.distance_counts, limits);
    TEST_ASSERT_AT_MOST_DOUBLE(1e-7, left_over(setpoints, task.mode));
    if (limits.deceleration_jerk == 0.0) TEST_ASSERT_AT_LEAST_INT64(plain.duration_ticks, plan.duration_ticks);
  }
  TEST_ASSERT_AT_LEAST_INT64(kMoves * 95 / 100, planned);
}

TEST(two_and_three_modes_are_left_still_at_once) {
  const Mode modes[] = {{11.0, 0.11}, {27.0, 0.02}, {18.0, 0.05}};
  const AxisLimits limits{2e6, 20e6, 15e6, 800e6};
  for (const size_t count : {size_t{2}, size_t{3}}) {
    for (const int32_t counts : {500000, -100000, 20000}) {
      TEST_INFO("counts", counts);
      Plan plan{};
      TEST_ASSERT_OK(plan_still(counts, limits, modes, count, kTick, plan));
      const std::vector<Signal> setpoints = sampled(plan, counts);
      check_stream(setpoints, counts, limits);
      for (size_t m = 0; m < count; ++m) TEST_ASSERT_AT_MOST_DOUBLE(1e-7, left_over(setpoints, modes[m]));
    }
  }
}

TEST(what_it_cannot_plan_is_refused_by_name_and_the_plan_stays) {
  const AxisLimits limits{2e6, 20e6, 20e6, 400e6};
  const Mode mode{11.0, 0.11};
  Plan plan{};
  plan.duration_ticks = 77;
  TEST_ASSERT_REFUSED(kNotAvailable, kStages, plan_still(1e5, limits, &mode, 0, kTick, plan));
  TEST_ASSERT_REFUSED(kNotAvailable, kStages, plan_still(1e5, limits, &mode, kMostStillModes + 1, kTick, plan));
  const Mode wrong{-1.0, 0.1};
  TEST_ASSERT_REFUSED(kNotPositive, kFrequency, plan_still(1e5, limits, &wrong, 1, kTick, plan));
  TEST_ASSERT_REFUSED(kNotPositive, kVelocity, plan_still(1e5, {0.0, 1.0, 1.0, 1.0}, &mode, 1, kTick, plan));
  TEST_ASSERT_EQUAL_UINT32(77, plan.duration_ticks);
  TEST_ASSERT_OK(plan_still(0.0, limits, &mode, 1, kTick, plan));
  TEST_ASSERT_EQUAL_UINT32(0, plan.duration_ticks);
}
