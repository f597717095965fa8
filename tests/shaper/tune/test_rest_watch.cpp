// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/rest_watch.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr uint32_t kWindow = 20;
constexpr uint32_t kPatience = 100;

struct Watching {
  RestWatch watch;
  Watching() { watch.arm(signal_from_counts(10), kWindow, kPatience); }

  // Ticks until it says so; 0 if it does not within `most`.
  template <typename Position>
  uint32_t ticks_to_rest(Position position, uint32_t most) {
    for (uint32_t n = 0; n < most; ++n) {
      if (watch.tick(true, signal_from_counts(position(n)), true)) return n + 1;
    }
    return 0;
  }
  void move() { TEST_ASSERT_FALSE(watch.tick(false, 0, true)); }
};

}  // namespace

TEST_F(Watching, before_a_motion_there_is_no_rest_after_it) {
  TEST_ASSERT_EQUAL_UINT32(0, ticks_to_rest([](uint32_t) { return 0; }, 1000));
}

TEST_F(Watching, a_motor_that_stands_with_the_axis_is_believed_a_window_later) {
  move();
  TEST_ASSERT_EQUAL_UINT32(kWindow, ticks_to_rest([](uint32_t n) { return static_cast<int32_t>(n % 3); }, 1000));
  // Once.
  TEST_ASSERT_EQUAL_UINT32(0, ticks_to_rest([](uint32_t) { return 0; }, 1000));
}

TEST_F(Watching, a_motor_that_creeps_in_is_waited_for) {
  move();
  const auto creeps = [](uint32_t n) { return n < 40 ? static_cast<int32_t>(40 * (40 - n)) : 0; };
  TEST_ASSERT_EQUAL_UINT32(40 + kWindow, ticks_to_rest(creeps, 1000));
}

TEST_F(Watching, a_motor_that_turns_round_slowly_does_not_rest) {
  move();
  // 20 counts either way, and 60 ticks a period: within ten for less than the window.
  const auto swings = [](uint32_t n) {
    const auto phase = static_cast<int32_t>(n % 60);
    return phase < 30 ? 3 * phase - 45 : 135 - 3 * phase;
  };
  TEST_ASSERT_EQUAL_UINT32(kPatience + kWindow, ticks_to_rest(swings, 1000));
}

TEST_F(Watching, a_stale_position_says_nothing) {
  move();
  for (uint32_t n = 0; n + 1 < kWindow; ++n)
    TEST_ASSERT_FALSE(watch.tick(true, signal_from_counts(static_cast<int32_t>(1000 * n)), n == 0));
  TEST_ASSERT_TRUE(watch.tick(true, 0, false));
}
