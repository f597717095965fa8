// SPDX-License-Identifier: Apache-2.0
// An axis whose shaper is changed in motion, held against what is promised of that.
#pragma once

#include "shaper/axis/axis.hpp"
#include "tests/support/shapers.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

constexpr double kTick = 1e-3;
constexpr AxisLimits kLimits{1.2e6, 20e6, 20e6, 600e6};
constexpr size_t kCapacity = 256;

inline ShaperDesign zv(double frequency_hz, double damping_ratio = 0.0) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{frequency_hz, damping_ratio}, kTick, design));
  return design;
}

inline bool same(const ShaperDesign& a, const ShaperDesign& b) {
  if (a.stage_count != b.stage_count || a.tap_count != b.tap_count) return false;
  for (uint32_t i = 0; i < a.tap_count; ++i) {
    if (a.taps[i].gain != b.taps[i].gain || a.taps[i].delay_ticks != b.taps[i].delay_ticks) return false;
  }
  return true;
}

inline bool averages(const ShaperDesign& design) {
  for (uint32_t i = 0; i < design.tap_count; ++i) {
    if (design.taps[i].gain < 0) return false;
  }
  return true;
}

// An axis beside two shapers that have run for ever, one before the change and one after it.
struct Retuning {
  Axis<kCapacity> axis = {};
  ShaperDesign before = {};
  ShaperDesign after = {};
  LineSample memory[2][kCapacity] = {};
  Shaper references[2] = {};
  uint32_t active_at = 0;  // tick of the move
  uint32_t tick = 0;
  bool in_motion = false;                      // active before rest
  double worst[3] = {-1e300, -1e300, -1e300};  // excess over a limit, LSB

  Retuning() { TEST_ASSERT_OK(axis.configure(AxisConfig{kTick, {1e9, 1e12, 1e12, 1e15}, 40e6, 2e9})); }

  void start_with(const ShaperDesign& from, const ShaperDesign& to) {
    before = from;
    after = to;
    if (!same(axis.shaper(), from)) {
      TEST_ASSERT_OK(axis.set_shaper(from));
      axis.tick();
    }
    const Signal position = axis.state().setpoint;
    TEST_ASSERT_OK(references[0].configure(from, memory[0], kCapacity, position));
    TEST_ASSERT_OK(references[1].configure(to, memory[1], kCapacity, position));
    tick = 0;
    active_at = 0;
    in_motion = false;
  }

  Status move_to(int32_t target, double duration_s = 0.0, const AxisLimits& limits = kLimits) {
    return axis.command(Move{target, ProfileKind::kSCurve, limits, duration_s, false}, nullptr);
  }

  // The setpoint is the old shaper's until the blend, the new one's after it, and between the two while it lasts.
  Signal step(bool commit = true) {
    const bool old_in_force = same(axis.shaper(), before);
    const Signal setpoint = axis.tick(commit);
    ++tick;
    const Signal demand = axis.state().demand;
    const Signal old_output = references[0].tick(demand);
    const Signal new_output = references[1].tick(demand);
    if (axis.state().phase == AxisPhase::kStopping) return setpoint;
    const Signal low = old_output < new_output ? old_output : new_output;
    const Signal high = old_output < new_output ? new_output : old_output;
    if (!old_in_force) {
      TEST_ASSERT_EQUAL_INT64(new_output, setpoint);
    } else {
      TEST_ASSERT_TRUE(low <= setpoint && setpoint <= high);
      if (!axis.pending() && same(axis.shaper(), after)) {
        active_at = tick;
        in_motion = axis.state().phase != AxisPhase::kAtRest;
        TEST_ASSERT_EQUAL_INT64(new_output, setpoint);
      }
    }
    return setpoint;
  }

  uint32_t stages() const { return before.stage_count + after.stage_count + 1; }

  // A move with the change asked for at `at`; checks everything that is promised.
  void run(int32_t target, uint32_t at, const AxisLimits& limits, bool service = true, bool jerk_limited = true) {
    const Signal end = signal_from_counts(target);
    const Signal start = axis.state().setpoint;
    StreamCheck check(start, end >= start, limits, kTick);
    do {
      if (tick == at) TEST_ASSERT_OK(axis.set_shaper(after, Retune::kBlended));
      if (service) axis.service();
      check.next(step());
    } while (axis.state().phase != AxisPhase::kAtRest);
    TEST_ASSERT_EQUAL_INT64(end, axis.state().setpoint);
    const double excess[] = {check.velocity_excess, check.acceleration_excess,
                             jerk_limited ? check.jerk_excess : -1e300};
    for (int i = 0; i < 3; ++i) {
      if (excess[i] > worst[i]) worst[i] = excess[i];
    }
    TEST_INFO("velocity", check.velocity_excess);
    TEST_INFO("acceleration", check.acceleration_excess);
    TEST_INFO("jerk", check.jerk_excess);
    TEST_ASSERT_TRUE(check.within(stages(), jerk_limited));
    if (averages(before) && averages(after)) TEST_ASSERT_TRUE(check.backwards <= stages() + 1.0);
    for (int i = 0; i < 4; ++i) TEST_ASSERT_EQUAL_INT64(end, axis.tick());
    TEST_ASSERT_FALSE(axis.pending());
  }
};

}  // namespace stillpoint::testing
