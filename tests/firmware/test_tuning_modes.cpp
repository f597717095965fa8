// SPDX-License-Identifier: Apache-2.0
// A tuning beside the other modes: none of them gets the axis, and none of them is forgotten.
#include "tests/firmware/tune_rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kNotStanding = 0x8100, kTuning = 0x9100;

struct InMode : Tunable {
  void set_mode(uint32_t mode) {
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, mode));
    step(5);
  }
  int64_t last() const { return arm.setpoints.back(); }
};

TEST_F(InMode, a_velocity_is_refused_until_the_tuning_is_over) {
  set_mode(3);
  TEST_ASSERT_EQUAL_UINT32(3, get(0x0043));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  TEST_ASSERT_EQUAL_UINT32(6, write_wide(0x0052, 10000));
  expect_refused(kTuning, 0x0052);
  reach(TuneState::kProposed);
  arm.forget();
  TEST_ASSERT_EQUAL_UINT32(6, write_wide(0x0052, 10000));
  step(300);
  TEST_ASSERT_TRUE(still());
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAccept));
  reach(TuneState::kKept);
  TEST_ASSERT_EQUAL_INT64(0, last());
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0052, 10000));
  step(500);
  TEST_ASSERT_TRUE(last() > 3000 * kCount);
}

TEST_F(InMode, it_does_not_start_while_a_velocity_is_followed) {
  set_mode(3);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0052, 10000));
  TEST_ASSERT_EQUAL_UINT32(6, tune(kStart));
  expect_refused(kNotStanding, 0x0200);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0052, 0));
  step(300);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
}

TEST_F(InMode, it_does_not_start_with_a_set_point_behind_the_one_under_way) {
  start_move(200000);
  control(0x0F);
  start_move(100000);  // kept until the first has arrived
  for (int i = 0; i < 40; ++i) {
    const uint32_t refused = tune(kStart);
    if (last() != 100000 * kCount) {
      TEST_ASSERT_EQUAL_UINT32(6, refused);
    } else if (refused == 0) {
      return;
    }
  }
  TEST_ASSERT_TRUE(false);
}

TEST_F(InMode, another_mode_waits_for_its_end_and_homing_with_it) {
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  reach(TuneState::kProposed);
  set_mode(6);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0043));
  arm.forget();
  control(0x1F);
  expect_refused(kTuning, 0x0040);
  step(50);
  TEST_ASSERT_TRUE(still());
  TEST_ASSERT_EQUAL_INT32(100000, get_wide(0x0046));
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAbort));
  reach(TuneState::kFailed);
  step(5);
  TEST_ASSERT_EQUAL_UINT32(6, get(0x0043));
  control(0x1F);
  step(5);
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x0046));
  // From here it is tuned as from anywhere.
  control(0x0F);
  run_to_kept();
  TEST_ASSERT_EQUAL_INT32(0, get_wide(0x0046));
}

TEST_F(InMode, after_a_halt_it_starts_again) {
  start_move(200000);
  control(0x0F);
  step(30);
  control(0x10F);
  step(500);
  control(0x0F);
  step(100);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
}

TEST_F(InMode, a_velocity_written_in_another_mode_does_not_keep_it_from_starting) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0052, 10000));
  step(100);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
}

TEST_F(InMode, a_stream_does_not_begin_in_it) {
  set_mode(8);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  reach(TuneState::kProposed);
  arm.forget();
  control(0x1F);
  expect_refused(kTuning, 0x0040);
  step(50);
  TEST_ASSERT_TRUE(still());
}

// Every way in which 0078 has a quick stop end.
TEST(a_quick_stop_by_any_option_aborts_it) {
  for (const uint32_t option : {0U, 1U, 2U, 5U, 6U}) {
    TEST_INFO("option", option);
    InMode rig;
    rig.unlock();
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0078, option));
    TEST_ASSERT_EQUAL_UINT32(0, rig.tune(kStart));
    rig.reach(TuneState::kExciting);
    rig.step(250);
    rig.control(0x02);
    rig.reach_end();
    TEST_ASSERT_EQUAL_UINT32(9, rig.get(0x0208));
    TEST_ASSERT_EQUAL_UINT32(6, rig.get(0x020A));
    TEST_ASSERT_TRUE(rig.reach_from(0) <= 200000.0);
    rig.control(0x00);
    rig.enable();
    rig.run_to_kept();
  }
}

}  // namespace
