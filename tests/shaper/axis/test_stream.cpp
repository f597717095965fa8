// SPDX-License-Identifier: Apache-2.0
// Setpoints that a master streams, one a tick, through an axis.
#include "shaper/axis/axis.hpp"
#include "tests/shaper/profile/moving_stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::MovingStreamCheck;

namespace {

constexpr double kTick = 1e-3;
constexpr AxisLimits kMaximum{2e6, 40e6, 40e6, 2e9};
constexpr AxisLimits kLimits{1.2e6, 20e6, 20e6, 600e6};

// An axis that is streamed to, and the axis of a master that plans the moves.
struct Streaming {
  Axis<512> axis = {};
  Axis<16> master = {};

  Streaming() {
    TEST_ASSERT_OK(axis.configure(AxisConfig{kTick, kMaximum, 40e6, 2e9}));
    TEST_ASSERT_OK(master.configure(AxisConfig{kTick, kMaximum, 40e6, 2e9}));
  }

  void shape() {
    ShaperDesign design{};
    TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{11.0, 0.11}, kTick, design));
    TEST_ASSERT_OK(axis.set_shaper(design));
    axis.tick();
  }

  Status begin(StreamPolicy policy = StreamPolicy::kClamp, uint32_t made_up_ticks = 3) {
    return axis.begin_stream(StreamConfig{kLimits, policy, made_up_ticks});
  }

  void plan(int32_t target, const AxisLimits& limits = kLimits) {
    TEST_ASSERT_OK(master.command(Move{target, ProfileKind::kSCurve, limits, 0.0, false}, nullptr));
  }

  // One tick of both.
  Signal step() {
    axis.stream(master.tick());
    return axis.tick();
  }

  void drain() {
    for (int tick = 0; tick < 2000 && axis.state().phase != AxisPhase::kAtRest; ++tick) axis.tick();
    TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kAtRest);
  }
};

}  // namespace

TEST_F(Streaming, what_keeps_the_limits_is_followed_bit_for_bit) {
  TEST_ASSERT_OK(begin(StreamPolicy::kFault));
  plan(1700000);
  for (int tick = 0; tick < 1600; ++tick) {
    const Signal setpoint = step();
    TEST_ASSERT_EQUAL_INT64(master.state().setpoint, setpoint);
  }
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kStreaming);
  TEST_ASSERT_EQUAL_UINT32(0, axis.stream_state().limited_ticks);
  TEST_ASSERT_OK(axis.halt(kLimits, nullptr));
  drain();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), axis.state().setpoint);
}

TEST_F(Streaming, what_leaves_is_shaped) {
  shape();
  LineSample memory[512] = {};
  Shaper shaper = {};
  TEST_ASSERT_OK(shaper.configure(axis.shaper(), memory, 512, 0));
  TEST_ASSERT_OK(begin());
  plan(1700000);
  for (int tick = 0; tick < 1600; ++tick) {
    const Signal setpoint = step();
    TEST_ASSERT_EQUAL_INT64(shaper.tick(master.state().setpoint), setpoint);
  }
}

TEST_F(Streaming, what_breaks_the_limits_is_clamped_and_said) {
  shape();
  TEST_ASSERT_OK(begin());
  axis.tick();
  MovingStreamCheck check(0, kLimits, kTick, 1);
  axis.stream(signal_from_counts(500000));  // half a unit in one tick
  check.next(axis.tick());
  TEST_ASSERT_TRUE(axis.stream_state().limiting);
  for (int tick = 0; tick < 1500; ++tick) {
    axis.stream(signal_from_counts(500000));
    check.next(axis.tick());
  }
  TEST_ASSERT_TRUE(check.within());
  TEST_ASSERT_FALSE(axis.stream_state().limiting);
  TEST_ASSERT_AT_LEAST_INT64(300, axis.stream_state().limited_ticks);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(500000), axis.state().setpoint);
}

TEST_F(Streaming, where_it_is_to_fault_it_stops_within_the_limits_and_ends) {
  TEST_ASSERT_OK(begin(StreamPolicy::kFault));
  plan(1700000);
  MovingStreamCheck check(0, kLimits, kTick);
  for (int tick = 0; tick < 500; ++tick) check.next(step());
  for (int tick = 0; tick < 500; ++tick) {
    axis.stream(0);
    check.next(axis.tick());
  }
  TEST_ASSERT_TRUE(check.within());
  TEST_ASSERT_TRUE(axis.stream_state().faulted);
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kAtRest);
  TEST_ASSERT_OK(axis.command(Move{5, ProfileKind::kSCurve, kLimits, 0.0, false}, nullptr));
  axis.tick();
  drain();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(5), axis.state().setpoint);
}

TEST_F(Streaming, a_master_that_falls_silent_is_taken_to_stand) {
  TEST_ASSERT_OK(begin());
  plan(1700000);
  MovingStreamCheck check(0, kLimits, kTick);
  for (int tick = 0; tick < 500; ++tick) check.next(step());
  for (int tick = 0; tick < 500; ++tick) check.next(axis.tick());
  TEST_ASSERT_TRUE(check.within());
  const Signal stands = axis.state().setpoint;
  TEST_ASSERT_EQUAL_INT64(stands, axis.tick());
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kStreaming);
}

TEST_F(Streaming, a_quick_stop_ends_it_and_what_needs_rest_waits_for_its_end) {
  TEST_ASSERT_OK(begin());
  TEST_ASSERT_REFUSED(kBusy, kNone, begin());
  plan(1700000);
  for (int tick = 0; tick < 300; ++tick) step();
  TEST_ASSERT_REFUSED(kBusy, kNone, axis.command(Move{5, ProfileKind::kSCurve, kLimits, 0.0, false}, nullptr));
  TEST_ASSERT_REFUSED(kBusy, kNone, axis.set_shaper(ShaperDesign{}));
  axis.request_stop();
  drain();
  const Signal stands = axis.state().setpoint;
  for (int tick = 0; tick < 100; ++tick) TEST_ASSERT_EQUAL_INT64(stands, step());
}

TEST_F(Streaming, a_stream_stops_in_front_of_a_soft_limit) {
  AxisConfig config = axis.config();
  config.soft_low_counts = -10;
  config.soft_high_counts = 300000;
  TEST_ASSERT_OK(axis.configure(config));
  TEST_ASSERT_OK(begin());
  plan(1700000);
  MovingStreamCheck check(0, kLimits, kTick);
  for (int tick = 0; tick < 2500; ++tick) {
    const Signal setpoint = step();
    check.next(setpoint);
    TEST_ASSERT_AT_MOST_INT64(signal_from_counts(300000), setpoint);
  }
  TEST_ASSERT_TRUE(check.within());
  TEST_ASSERT_TRUE(axis.stream_state().limiting);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(300000), axis.state().setpoint);
}

TEST_F(Streaming, bad_streams_are_refused_by_name) {
  Axis<16> raw = {};
  TEST_ASSERT_REFUSED(kNotAvailable, kNone, raw.begin_stream(StreamConfig{kLimits, StreamPolicy::kClamp, 0}));
  TEST_ASSERT_REFUSED(kNotPositive, kJerk, axis.begin_stream(StreamConfig{{1, 1, 1, 0}, StreamPolicy::kClamp, 0}));
  TEST_ASSERT_REFUSED(kAboveMaximum, kVelocity,
                      axis.begin_stream(StreamConfig{{2.1e6, 1, 1, 1}, StreamPolicy::kClamp, 0}));
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kUmZv, Mode{11.0, 0.0}, kTick, design));
  TEST_ASSERT_OK(axis.set_shaper(design));
  axis.tick();
  TEST_ASSERT_REFUSED(kNotAvailable, kKind, begin());
  TEST_ASSERT_FALSE(axis.pending());
}
