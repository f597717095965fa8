// SPDX-License-Identifier: Apache-2.0
#include "firmware/control_loop.hpp"

#include <cmath>

#include "tests/firmware/rig.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;
using namespace stillpoint::testing;

namespace {

constexpr int64_t kCount = int64_t{1} << 32;

struct Loop {
  Axis<256> axis;
  Servo servo;
  ControlLoop loop;

  Loop() {
    TEST_ASSERT_OK(axis.configure(kDefaultAxis));
    loop.begin(axis, servo);
    loop.set_position_window(100);
  }

  void tick(uint32_t ticks = 1) {
    for (uint32_t i = 0; i < ticks; ++i) loop.tick();
  }
  void enable() {
    tick();
    loop.request_enabled(true);
    tick();
    TEST_ASSERT_TRUE(servo.enabled());
  }
  void move(int32_t target) {
    const Move move = {target, ProfileKind::kSCurve, {1.2e6, 2e7, 2e7, 6e8}, 0.0, false};
    TEST_ASSERT_OK(axis.command(move, nullptr));
  }
  void lose_feedback(uint32_t ticks) {
    servo.valid = false;
    tick(ticks);
    servo.valid = true;
  }
};

struct Enabled : Loop {
  Enabled() { enable(); }
};

TEST_F(Loop, nothing_is_enabled_until_asked) {
  tick(5);
  for (const hal::ServoCommand& command : servo.commands) TEST_ASSERT_FALSE(command.enabled);
}

TEST_F(Loop, enabling_starts_from_the_actual_position_without_a_step) {
  servo.position = 123456 * kCount;
  tick(3);
  loop.request_enabled(true);
  tick(3);
  for (const hal::ServoCommand& command : servo.commands) {
    if (command.enabled) TEST_ASSERT_EQUAL_INT64(123456 * kCount, command.setpoint);
  }
  TEST_ASSERT_TRUE(servo.enabled());
  TEST_ASSERT_TRUE(loop.snapshot().enabled);
}

TEST_F(Loop, enabling_waits_for_valid_feedback) {
  servo.valid = false;
  loop.request_enabled(true);
  tick(10);
  TEST_ASSERT_FALSE(servo.enabled());
  servo.valid = true;
  tick(2);
  TEST_ASSERT_TRUE(servo.enabled());
}

TEST_F(Enabled, a_move_starts_at_the_tick_after_the_commit_and_not_before) {
  servo.commit = false;
  tick(2);
  move(100000);
  tick(10);
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());
  servo.commit = true;
  tick();  // this exchange brings the commit
  TEST_ASSERT_EQUAL_INT64(0, servo.setpoint());
  tick();
  TEST_ASSERT_AT_LEAST_INT64(1, servo.setpoint());
}

TEST_F(Enabled, two_missing_feedbacks_are_no_fault_and_three_are) {
  lose_feedback(2);
  tick(5);
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
  lose_feedback(2);
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
  lose_feedback(1);
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kFeedbackMissing, loop.snapshot().fault);
  TEST_ASSERT_EQUAL_UINT32(5, loop.snapshot().missing);
}

TEST_F(Enabled, a_gap_counts_as_many_feedbacks_as_are_missing_in_it) {
  servo.sequence = static_cast<uint16_t>(servo.sequence + 2);  // two never came
  tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
  TEST_ASSERT_EQUAL_UINT32(2, loop.snapshot().missing);
  servo.sequence = static_cast<uint16_t>(servo.sequence + 3);
  tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kFeedbackMissing, loop.snapshot().fault);
  TEST_ASSERT_EQUAL_UINT32(5, loop.snapshot().missing);
}

TEST_F(Enabled, a_gap_and_invalid_feedback_in_a_row_add_up) {
  servo.sequence = static_cast<uint16_t>(servo.sequence + 1);
  servo.valid = false;
  tick();
  TEST_ASSERT_EQUAL_UINT32(2, loop.snapshot().missing);
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
  tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kFeedbackMissing, loop.snapshot().fault);
}

TEST_F(Enabled, a_feedback_seen_again_is_a_missing_one) {
  servo.count_up = false;
  tick(2);
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
  tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kFeedbackMissing, loop.snapshot().fault);
  TEST_ASSERT_EQUAL_UINT32(3, loop.snapshot().missing);
}

TEST_F(Enabled, a_sequence_that_goes_back_is_a_fault) {
  servo.sequence = static_cast<uint16_t>(servo.sequence - 10);
  tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kFeedbackMissing, loop.snapshot().fault);
  TEST_ASSERT_EQUAL_UINT32(3, loop.snapshot().missing);
}

TEST_F(Enabled, a_sequence_that_wraps_has_no_gap) {
  tick(0x10000);
  TEST_ASSERT_EQUAL_UINT32(0, loop.snapshot().missing);
}

TEST_F(Loop, missing_feedback_while_disabled_is_counted_but_no_fault) {
  tick();
  lose_feedback(10);
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
  TEST_ASSERT_EQUAL_UINT32(10, loop.snapshot().missing);
}

TEST_F(Enabled, silence_is_a_fault_at_the_hundredth_millisecond) {
  for (int i = 0; i < 99; ++i) loop.own_timer_tick();
  tick();
  for (int i = 0; i < 99; ++i) loop.own_timer_tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
  TEST_ASSERT_FALSE(loop.snapshot().link_silent);
  loop.own_timer_tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kLinkSilent, loop.snapshot().fault);
  TEST_ASSERT_TRUE(loop.snapshot().link_silent);
  TEST_ASSERT_EQUAL_UINT32(1, loop.snapshot().link_losses);
}

TEST_F(Loop, silence_while_disabled_is_a_loss_but_no_fault) {
  for (int i = 0; i < 500; ++i) loop.own_timer_tick();
  TEST_ASSERT_EQUAL_UINT32(0, loop.snapshot().link_losses);  // it has never been there
  tick();
  for (int i = 0; i < 500; ++i) loop.own_timer_tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
  TEST_ASSERT_EQUAL_UINT32(1, loop.snapshot().link_losses);
  TEST_ASSERT_FALSE(loop.snapshot().feedback_valid);
}

TEST_F(Enabled, a_link_that_stays_dead_ends_the_fault_reaction_after_a_second) {
  move(1000000);
  tick(100);
  for (int i = 0; i < 999; ++i) loop.own_timer_tick();
  TEST_ASSERT_TRUE(loop.snapshot().enabled);
  TEST_ASSERT_TRUE(servo.enabled());
  loop.own_timer_tick();
  TEST_ASSERT_FALSE(loop.snapshot().enabled);
  TEST_ASSERT_FALSE(servo.enabled());  // at the port itself: no exchange comes to say it
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kLinkSilent, loop.snapshot().fault);
  tick(3);
  TEST_ASSERT_FALSE(servo.enabled());
}

// From every part of the move, on the stream itself: third difference within the quick stop's jerk, second within its
// deceleration or what the move had, at rest in the end, enabled until it stands.
TEST(a_fault_ramps_to_rest_within_the_quick_stop_limits) {
  const double deceleration = kDefaultAxis.quick_stop_deceleration * 1e-6 * 4294967296.0;
  const double jerk = kDefaultAxis.quick_stop_jerk * 1e-9 * 4294967296.0;
  for (uint32_t moment = 1; moment < 1510; moment += 31) {
    TEST_INFO("ticks of the move", moment);
    Enabled rig;
    rig.move(1700000);
    rig.tick(moment);
    const size_t before = rig.servo.commands.size();
    rig.lose_feedback(3);
    rig.tick(200);
    TEST_ASSERT_EQUAL_ENUM(FaultCode::kFeedbackMissing, rig.loop.snapshot().fault);
    TEST_ASSERT_FALSE(rig.servo.enabled());
    const std::vector<hal::ServoCommand>& stream = rig.servo.commands;
    size_t last_change = 0;
    for (size_t i = before; i < stream.size(); ++i) {
      const auto d1 = static_cast<double>(stream[i].setpoint - stream[i - 1].setpoint);
      const auto d2 = d1 - static_cast<double>(stream[i - 1].setpoint - stream[i - 2].setpoint);
      const auto d2_before = static_cast<double>(stream[i - 1].setpoint - stream[i - 2].setpoint) -
                             static_cast<double>(stream[i - 2].setpoint - stream[i - 3].setpoint);
      TEST_INFO("tick", i - before);
      TEST_ASSERT_AT_MOST_DOUBLE(jerk + 4, std::fabs(d2 - d2_before));
      TEST_ASSERT_AT_MOST_DOUBLE(deceleration + 2, std::fabs(d2));
      if (stream[i].setpoint != stream[i - 1].setpoint) last_change = i;
      if (stream[i].setpoint != stream[i - 1].setpoint) TEST_ASSERT_TRUE(stream[i].enabled);
    }
    TEST_ASSERT_AT_LEAST_INT64(1, static_cast<int64_t>(last_change));
    TEST_ASSERT_AT_MOST_INT64(static_cast<int64_t>(before) + 100, static_cast<int64_t>(last_change));
    TEST_ASSERT_TRUE(stream[last_change].enabled);  // one standing setpoint more under torque
  }
}

TEST_F(Enabled, a_fault_stays_until_it_is_cleared_and_clearing_waits_for_the_ramp) {
  move(1000000);
  tick(500);
  lose_feedback(3);
  loop.request_fault_clear();
  tick();
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kFeedbackMissing, loop.snapshot().fault);
  loop.request_enabled(false);
  tick(300);
  TEST_ASSERT_FALSE(loop.snapshot().enabled);
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, loop.snapshot().fault);
}

TEST_F(Enabled, nothing_planned_before_a_fault_starts_after_it) {
  servo.commit = false;
  tick();
  move(1000000);
  lose_feedback(3);
  servo.commit = true;
  tick(100);
  loop.request_enabled(false);
  loop.request_fault_clear();
  tick(10);
  loop.request_enabled(true);
  tick(2000);
  TEST_ASSERT_TRUE(servo.enabled());
  for (const hal::ServoCommand& command : servo.commands) TEST_ASSERT_EQUAL_INT64(0, command.setpoint);
}

// A background that has not seen the fault yet.
TEST_F(Enabled, nothing_commanded_in_a_fault_starts_in_it) {
  lose_feedback(3);
  tick(10);
  TEST_ASSERT_FALSE(servo.enabled());
  move(1000000);
  tick(100);
  for (const hal::ServoCommand& command : servo.commands) TEST_ASSERT_EQUAL_INT64(0, command.setpoint);
}

TEST_F(Enabled, disabling_takes_the_output_away_at_once_and_a_ramp_of_a_fault_is_not_cut) {
  move(1000000);
  tick(300);
  loop.request_enabled(false);
  tick();
  TEST_ASSERT_FALSE(servo.enabled());
  loop.request_enabled(true);
  tick(2);
  move(-1000000);
  tick(300);
  lose_feedback(3);
  loop.request_enabled(false);
  tick(5);
  TEST_ASSERT_TRUE(servo.enabled());
}

TEST_F(Enabled, settled_ticks_count_only_standing_in_the_window) {
  tick(10);
  TEST_ASSERT_AT_LEAST_INT64(10, loop.snapshot().settled_ticks);
  move(1000);
  tick(2);
  TEST_ASSERT_EQUAL_UINT32(0, loop.snapshot().settled_ticks);
  tick(500);
  TEST_ASSERT_AT_LEAST_INT64(100, loop.snapshot().settled_ticks);
}

// Positions from outside may be anything; the distance between the farthest two is not.
TEST_F(Enabled, a_position_at_the_other_end_of_the_range_is_outside_the_window) {
  struct Far final : hal::ServoPort {
    uint16_t sequence = 0;
    void disable() override {}
    hal::ServoFeedback exchange(const hal::ServoCommand&) override { return {INT64_MIN, 0, ++sequence, true, true}; }
  } far;
  ControlLoop other;
  axis.reset(INT64_MAX);
  other.begin(axis, far);
  other.set_position_window(100);
  for (int i = 0; i < 5; ++i) other.tick();
  TEST_ASSERT_EQUAL_UINT32(0, other.snapshot().settled_ticks);
}

TEST_F(Loop, counters_only_go_up) {
  Random random(7);
  LoopSnapshot last = loop.snapshot();
  for (int i = 0; i < 20000; ++i) {
    TEST_INFO("step", i);
    servo.valid = random.integer(0, 3) != 0;
    if (random.integer(0, 9) == 0) servo.sequence = static_cast<uint16_t>(random.next());
    if (random.integer(0, 99) == 0) loop.request_enabled(random.integer(0, 1) != 0);
    if (random.integer(0, 99) == 0) loop.request_fault_clear();
    for (int64_t ms = random.integer(0, 49) == 0 ? 120 : 1; ms > 0; --ms) loop.own_timer_tick();
    loop.tick();
    const LoopSnapshot now = loop.snapshot();
    TEST_ASSERT_AT_LEAST_INT64(last.ticks, now.ticks);
    TEST_ASSERT_AT_LEAST_INT64(last.missing, now.missing);
    TEST_ASSERT_AT_LEAST_INT64(last.link_losses, now.link_losses);
    last = now;
  }
}

}  // namespace
