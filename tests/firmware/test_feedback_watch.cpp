// SPDX-License-Identifier: Apache-2.0
#include "firmware/feedback_watch.hpp"

#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;

namespace {

constexpr Signal at(int32_t counts) { return signal_from_counts(counts); }

FeedbackLimits limits() {
  FeedbackLimits limits{};
  limits.following_window = 100;
  limits.ticks = 3;
  limits.most_per_tick = 5000;
  limits.low = -2000;
  limits.high = 3000;
  limits.margin = 50;
  return limits;
}

struct Watching {
  FeedbackWatch watch = {};
  Watching() { watch.set(limits()); }

  // Ticks until the fault, 0 for none within ten.
  uint32_t ticks_until(FaultCode fault, Signal setpoint, Signal position, Signal change = 0, bool neighbours = true) {
    for (uint32_t tick = 1; tick <= 10; ++tick) {
      const FaultCode seen = watch.look(setpoint, position, change, neighbours);
      if (seen == fault) return tick;
      TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, seen);
    }
    return 0;
  }
};

TEST(a_watch_that_was_never_set_sees_nothing) {
  FeedbackWatch watch = {};
  TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, watch.look(at(INT32_MAX), at(INT32_MIN), at(INT32_MAX), true));
}

TEST_F(Watching, a_following_error_may_last_for_its_time_and_no_longer) {
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kFollowingError, at(1000), at(900)));
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kFollowingError, at(900), at(1000)));
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kFollowingError, at(1000), at(900) - 1));
  watch.restart();
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kFollowingError, at(900) - 1, at(1000)));
}

TEST_F(Watching, a_following_error_that_ends_in_time_is_none) {
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 3; ++k) TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, watch.look(at(1000), at(0), 0, true));
    TEST_ASSERT_EQUAL_ENUM(FaultCode::kNone, watch.look(at(1000), at(1000), 0, true));
  }
}

TEST_F(Watching, a_jump_between_neighbours_is_implausible_and_over_a_gap_it_is_not) {
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kEncoderImplausible, 0, 0, at(5000)));
  TEST_ASSERT_EQUAL_UINT32(1, ticks_until(FaultCode::kEncoderImplausible, 0, 0, at(5000) + 1));
  TEST_ASSERT_EQUAL_UINT32(1, ticks_until(FaultCode::kEncoderImplausible, 0, 0, -at(5000) - 1));
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kEncoderImplausible, 0, 0, at(1000000), false));
  TEST_ASSERT_EQUAL_UINT32(1, ticks_until(FaultCode::kEncoderImplausible, 0, 0, INT64_MIN));
}

TEST_F(Watching, a_position_beyond_a_soft_limit_by_more_than_the_margin_is_one) {
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(3050), at(3050)));
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kPositionLimit, at(3051), at(3051)));
  watch.restart();
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(-2050), at(-2050)));
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kPositionLimit, at(-2050), at(-2050) - 1));
}

TEST_F(Watching, what_is_outside_when_it_is_looked_at_first_may_stay_and_come_back) {
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(9000), at(9000)));
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(9050), at(9050)));
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kPositionLimit, at(9051), at(9051)));
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(4000), at(4000)));
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(9000), at(9000)));
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(3050), at(3050)));
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kPositionLimit, at(3051), at(3051)));
}

// Within the margin it creeps nowhere.
TEST_F(Watching, what_is_outside_by_less_than_the_margin_gains_nothing_by_it) {
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(3049), at(3049)));
  watch.restart();
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(3050), at(3050)));
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kPositionLimit, at(3051), at(3051)));
}

TEST_F(Watching, the_ends_of_the_range_are_as_far_apart_as_they_are) {
  FeedbackLimits widest = limits();
  widest.low = INT32_MIN;
  widest.high = INT32_MIN + 1;
  watch.set(widest);
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(INT32_MIN), at(INT32_MIN)));
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kPositionLimit, at(INT32_MAX), at(INT32_MAX)));
  TEST_ASSERT_EQUAL_UINT32(UINT32_MAX - 51, watch.beyond_limit(at(INT32_MAX)));
}

TEST_F(Watching, limits_that_change_begin_anew) {
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(2500), at(2500)));
  FeedbackLimits closer = limits();
  closer.high = 1000;
  watch.set(closer);
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(2500), at(2500)));
  watch.set(closer);
  TEST_ASSERT_EQUAL_UINT32(4, ticks_until(FaultCode::kPositionLimit, at(2551), at(2551)));
}

TEST_F(Watching, without_soft_limits_and_windows_there_are_no_ends) {
  FeedbackLimits open = limits();
  open.low = open.high = 0;
  open.following_window = 0;
  open.most_per_tick = 0;
  watch.set(open);
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kPositionLimit, at(INT32_MIN), at(INT32_MAX), at(INT32_MAX)));
}

// Positions wrap; so does what they differ by.
TEST_F(Watching, the_end_of_the_position_range_is_no_following_error) {
  FeedbackLimits open = limits();
  open.low = open.high = 0;
  watch.set(open);
  TEST_ASSERT_EQUAL_UINT32(0, ticks_until(FaultCode::kFollowingError, at(INT32_MIN), at(INT32_MAX)));
}

}  // namespace
