// SPDX-License-Identifier: Apache-2.0
// Whole moves on the simulated arm.
#include <cmath>

#include "sim/evaluation.hpp"
#include "sim/experiment.hpp"
#include "sim/hash.hpp"
#include "sim/refusal.hpp"
#include "sim/spec.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::sim;

namespace {

// The reference move for the arm of Li 2017 (reference.md, section 5).
struct PaperArm {
  MoveTask task;
  ArmModes arm = {{{11.0, 0.11}, 1.0}};
  ShaperDesign zv = design_for(parse_shapers("zv:11:0.11"), 1e-3);

  PaperArm() {
    task.distance_counts = 1700000;
    task.limits = {1.2e6, 20e6, 20e6, 600e6};
    task.duration_s = 1.62;
  }

  Comparison compared(const MoveTask& shaped) const {
    return compare(task, run_axis(task, {}), shaped, run_axis(shaped, zv), arm, zv.stage_count, 0.2);
  }
};

}  // namespace

TEST_F(PaperArm, the_plain_move_rings_and_the_shaped_move_is_still) {
  const Comparison comparison = compared(task);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.62, comparison.plain_figures.move_time_s);
  TEST_ASSERT_DOUBLE_WITHIN(0.05, 13.0, comparison.plain_figures.residual_peak);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.21, *comparison.plain_figures.settling_time_s);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.666, comparison.shaped_figures.move_time_s);
  TEST_ASSERT_AT_MOST_DOUBLE(1e-8, comparison.residual_ratio);
  TEST_ASSERT_TRUE(*comparison.shaped_figures.settling_time_s == 0.0);
  TEST_ASSERT_TRUE(comparison.within_limits);
  TEST_ASSERT_FALSE(comparison.zero_delay_met);
}

TEST_F(PaperArm, zero_delay_arrives_in_the_time_of_the_plain_move_and_in_that_of_the_paper) {
  for (const double duration : {1.62, 1.60}) {
    MoveTask shaped = task;
    shaped.zero_delay = true;
    shaped.duration_s = duration;
    const Comparison comparison = compared(shaped);
    TEST_ASSERT_AT_MOST_DOUBLE(duration + 1e-9, comparison.shaped_figures.move_time_s);
    TEST_ASSERT_AT_MOST_DOUBLE(1e-8, comparison.residual_ratio);
    TEST_ASSERT_TRUE(comparison.within_limits);
    TEST_ASSERT_TRUE(comparison.zero_delay_met);
  }
}

TEST_F(PaperArm, what_the_limits_forbid_is_refused_as_not_possible) {
  task.duration_s = 1.4;
  try {
    static_cast<void>(run_axis(task, {}));
    FAIL("accepted");
  } catch (const Refusal& refusal) {
    TEST_ASSERT_EQUAL_INT32(1, refusal.exit_code());
    REQUIRE(refusal.result() == "duration_too_short");
    REQUIRE(std::string(refusal.what()) == "duration: 1.4: shorter than the limits allow, at least 1.51 s is accepted");
  }
}

TEST_F(PaperArm, a_move_too_long_to_be_recorded_is_refused) {
  task.duration_s = 1e6;
  REQUIRE_THROWS_AS(static_cast<void>(run_axis(task, {})), Refusal);
}

TEST_F(PaperArm, the_residual_is_that_of_the_closed_form) {
  // GIVEN a motor that moves by one unit at one speed in ten ticks THEN what is left is the sum of two ramps' rings.
  std::vector<Signal> setpoints;
  for (int i = 0; i <= 10; ++i) setpoints.push_back(signal_from_counts(100000 * i));
  for (int i = 0; i < 20; ++i) setpoints.push_back(signal_from_counts(1000000));
  const Rest rest = rest_of(setpoints, task, {{{11.0, 0.0}, 1.0}});
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.010, rest.move_time_s);
  // Undamped: each corner of the ramp, a slope change of s, rings with s / w; they differ by the phase w 0.01 s.
  const double w = 2.0 * std::acos(-1.0) * 11.0;
  const double expected = 100.0 * w * 2.0 * std::sin(w * 0.010 / 2.0);
  TEST_ASSERT_DOUBLE_RELATIVE(2e-3, expected, rest.residual_peak);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, expected, rest.arm.acceleration_envelope());
}

TEST_F(PaperArm, an_undamped_arm_never_settles) {
  std::vector<Signal> setpoints = {0, signal_from_counts(1000)};
  const Rest rest = rest_of(setpoints, task, {{{300.0, 0.0}, 1.0}});
  TEST_ASSERT_FALSE(settling_time_s(rest, 0.2 * rest.residual_peak).has_value());
}

TEST_F(PaperArm, settling_ends_where_the_acceleration_stays_in_the_band) {
  const Recording plain = run_axis(task, {});
  const Rest rest = rest_of(plain.setpoints, task, arm);
  for (const double band : {0.5, 0.2, 0.05, 0.01}) {
    const double threshold = band * rest.residual_peak;
    const double settling = settling_time_s(rest, threshold).value();
    Arm free = rest.arm;
    double last = 0.0;
    for (double t = free.step_s(); t < 3.0; t += free.step_s()) {
      free.step(0.0);
      if (std::abs(free.acceleration()) > threshold) last = t;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1.5 * free.step_s(), last, settling);
  }
}

TEST_F(PaperArm, streams_are_measured_by_their_differences) {
  task.distance_counts = -10;
  task.limits = {3e3, 2e6, 4e6, 6e9};  // counts: 3 a tick, 2 and 4 a tick^2, 6 a tick^3
  std::vector<Signal> setpoints;
  for (const int counts : {0, -2, -5, -8, -10, -10}) setpoints.push_back(signal_from_counts(counts));
  const StreamFigures figures = evaluate_stream(setpoints, task, 0);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 3e-3, figures.peak_velocity);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 2.0, figures.peak_acceleration);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 2e3, figures.peak_jerk);
  TEST_ASSERT_TRUE(figures.within_limits);
  // An LSB more than the allowance of 1, 2, 4 breaks the limit it belongs to, speeding up and slowing down apart.
  setpoints[1] -= 3;
  TEST_ASSERT_FALSE(evaluate_stream(setpoints, task, 0).within_limits);
  TEST_ASSERT_TRUE(evaluate_stream(setpoints, task, 1).within_limits);
}

TEST_F(PaperArm, the_last_difference_counts_too) {
  task.distance_counts = 1;
  task.limits = {1e3, 1e6, 0.5e6, 1e12};
  // One count in one tick: stopping takes a deceleration of a count a tick^2.
  const std::vector<Signal> setpoints = {0, signal_from_counts(1)};
  TEST_ASSERT_FALSE(evaluate_stream(setpoints, task, 0).within_limits);
  task.limits.deceleration = 1e6;
  TEST_ASSERT_TRUE(evaluate_stream(setpoints, task, 0).within_limits);
}

TEST_HOST(a_hash_is_of_what_changes_and_of_nothing_before_or_after) {
  const uint64_t hash = setpoint_hash({0, 5, 9, 9});
  TEST_ASSERT_EQUAL_UINT64(hash, setpoint_hash({0, 0, 0, 5, 9}));
  TEST_ASSERT_TRUE(hash != setpoint_hash({0, 5, 5, 9}));
  TEST_ASSERT_TRUE(hash != setpoint_hash({0, 5, 8}));
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0xCBF29CE484222325), setpoint_hash({3, 3}));
  // FNV-1a of eight bytes, from its definition.
  uint64_t expected = UINT64_C(0xCBF29CE484222325);
  for (const uint64_t byte : {1U, 0U, 0U, 0U, 0U, 0U, 0U, 0x80U}) {
    expected = (expected ^ byte) * UINT64_C(0x100000001B3);
  }
  TEST_ASSERT_EQUAL_UINT64(expected, setpoint_hash({0, INT64_MIN + 1}));
}
