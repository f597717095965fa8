// SPDX-License-Identifier: Apache-2.0
// A tuning that is broken off, in each of its states and by each of the ways: the axis stays within its travel, the
// registers say so, the shaper of before is in force, and the drive can be used.
#include "tests/firmware/tune_rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

enum class Way : uint32_t { kCommand, kHalt, kQuickStop, kDisableOperation, kDisableVoltage, kFeedback, kSilence };
constexpr Way kWays[] = {Way::kCommand,        Way::kHalt,     Way::kQuickStop, Way::kDisableOperation,
                         Way::kDisableVoltage, Way::kFeedback, Way::kSilence};
constexpr TuneState kStates[] = {TuneState::kExciting, TuneState::kCapturing, TuneState::kProposed,
                                 TuneState::kApplying, TuneState::kVerifying};

struct BrokenOff : Tunable {
  uint32_t length_before = 0;

  BrokenOff() {
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, 0, 0x0006, 0x1A80, 0, 0, 1, 0, 0, 0}));  // ZV of 40 Hz
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    step(50);
    length_before = axis.shaper().length_ticks();
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0249, 0));
    arm.forget();
  }

  void go_to(TuneState state) {
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0248, state > TuneState::kProposed ? 1 : 0));
    TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
    if (state == TuneState::kApplying) arm.drive.set_commit(false);
    reach(state);
  }

  void break_off(Way way) {
    switch (way) {
      case Way::kCommand: TEST_ASSERT_EQUAL_UINT32(0, tune(kAbort)); break;
      case Way::kHalt: control(0x10F); break;
      case Way::kQuickStop: control(0x02); break;
      case Way::kDisableOperation: control(0x07); break;
      case Way::kDisableVoltage: control(0x00); break;
      case Way::kFeedback:
        arm.drive.set_valid(false);
        step(4);
        arm.drive.set_valid(true);
        break;
      case Way::kSilence: step_silent(150); break;
    }
  }

  void bring_back() {
    arm.drive.set_commit(true);
    step(500);
    control(0x00);
    control(0x80);
    control(0x00);
    enable();
    step(50);
  }

  void expect_broken_off() {
    TEST_ASSERT_EQUAL_UINT32(9, get(0x0208));
    TEST_ASSERT_EQUAL_UINT32(6, get(0x020A));
    TEST_ASSERT_TRUE(reach_from(0) <= 200000.0);
    TEST_ASSERT_EQUAL_UINT32(length_before, axis.shaper().length_ticks());
    TEST_ASSERT_EQUAL_UINT32(400000, get_wide(0x0102));
  }

  // Bounded before each step by what the axis may do.
  void expect_within_limits() {
    const double most = 1.001e9 * 1e-6 * static_cast<double>(kCount);
    for (size_t i = 2; i < arm.setpoints.size(); ++i) {
      const int64_t* s = &arm.setpoints[i];
      TEST_ASSERT_TRUE(std::fabs(static_cast<double>(s[0] - 2 * s[-1] + s[-2])) <= most);
    }
  }
};

TEST(every_way_out_of_every_state_leaves_a_drive_that_can_be_used) {
  for (const TuneState state : kStates) {
    for (const Way way : kWays) {
      BrokenOff rig;
      TEST_INFO("state", static_cast<uint32_t>(state));
      TEST_INFO("way", static_cast<uint32_t>(way));
      rig.go_to(state);
      rig.break_off(way);
      rig.expect_within_limits();
      rig.bring_back();
      rig.expect_broken_off();
      rig.ringing_after_move(20000);
      TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0248, 0));
      rig.run_to_kept();
    }
  }
}

TEST_F(BrokenOff, an_abort_before_the_first_motion_leaves_the_axis_where_it_was) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0249, 500));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAbort));
  step(2000);
  TEST_ASSERT_TRUE(still());
  expect_broken_off();
  run_to_kept();
}

TEST_F(BrokenOff, a_halt_ramps_by_the_profile_and_a_move_can_follow_when_it_is_taken_back) {
  go_to(TuneState::kExciting);
  step(60);
  control(0x10F);
  step(300);
  TEST_ASSERT_TRUE(arm.enabled);
  expect_within_limits();
  control(0x0F);
  expect_broken_off();
  ringing_after_move(-30000);
}

// The ramp of an abort ends between two counts, and the next move goes to a whole one: no further than it may.
TEST_F(BrokenOff, an_amplitude_of_the_whole_travel_starts_from_wherever_an_abort_has_left_it) {
  constexpr int64_t kTravel = 100000;
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0202, {0x0001, 0x86A0, 0x0001, 0x86A0}));
  uint32_t rounded_up = 0;
  for (uint32_t i = 0; i < 24; ++i) {
    TEST_INFO("abort", i);
    if (i >= 12) {  // downwards
      unlock();
      const auto high = static_cast<uint32_t>(arm.setpoints.back() / kCount + 50000);
      TEST_ASSERT_EQUAL_UINT32(
          0, write(0x0074, {0x8000, 0, static_cast<uint16_t>(high >> 16), static_cast<uint16_t>(high)}));
    }
    const int64_t stands = arm.setpoints.back();
    arm.forget();
    TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
    step(20 + 5 * i);
    TEST_ASSERT_EQUAL_UINT32(0, tune(kAbort));
    step(400);
    for (const int64_t setpoint : arm.setpoints) TEST_ASSERT_TRUE(std::llabs(setpoint - stands) <= kTravel * kCount);
    TEST_ASSERT_TRUE(i < 12 ? arm.setpoints.back() > stands : arm.setpoints.back() < stands);
    rounded_up += (arm.setpoints.back() & (kCount / 2)) != 0 ? 1U : 0U;
  }
  TEST_ASSERT_AT_LEAST_INT64(6, rounded_up);
  TEST_ASSERT_AT_MOST_INT64(18, rounded_up);
}

// Heard while the identification runs: ticks come, and with them the client's bytes, in the middle of it.
TEST_F(BrokenOff, an_abort_in_the_identification_is_heard_in_it) {
  bool sent = false;
  uint32_t ticks_inside = 0;
  line.on_read = [&] {
    if (tune_state() != TuneState::kIdentifying) return;
    drive.tick();
    drive.own_timer_tick();
    ++ticks_inside;
    if (!sent) send(framed({1, 6, 2, 0, 0, kAbort}));
    sent = true;
  };
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  reach_end();
  line.on_read = nullptr;
  TEST_ASSERT_TRUE(sent);
  TEST_ASSERT_AT_LEAST_INT64(10, ticks_inside);
  answer();
  expect_broken_off();
  run_to_kept();
}

// The same for what takes the drive out of operation, and for its watchdog.
TEST_F(BrokenOff, a_quick_stop_in_the_identification_takes_the_output_away_in_it) {
  bool sent = false;
  bool went_off = false;
  const uint32_t meals = dog.meals;
  uint32_t meals_inside = 0;
  line.on_read = [&] {
    if (tune_state() != TuneState::kIdentifying) return;
    drive.tick();
    drive.own_timer_tick();
    if (!sent) send(framed({1, 6, 0, 0x40, 0, 0x02}));
    sent = true;
    went_off = went_off || !arm.enabled;
    meals_inside = dog.meals - meals;
  };
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  reach_end();
  line.on_read = nullptr;
  TEST_ASSERT_TRUE(went_off);
  TEST_ASSERT_AT_LEAST_INT64(10, meals_inside);
  answer();
  TEST_ASSERT_EQUAL_UINT32(0x0040, status() & 0x004F);
  bring_back();
  expect_broken_off();
}

}  // namespace
