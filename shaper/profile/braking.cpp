// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/braking.hpp"

#include "shaper/base/divide.hpp"
#include "shaper/base/wide.hpp"

namespace stillpoint {

namespace {

// floor(braking / jerk), and as a braking.
struct Level {
  uint64_t count;
  uint64_t braking;
};

Level level_of(int64_t braking, int64_t jerk) {
  if (braking < jerk) return Level{0, 0};
  const uint64_t count = divide(static_cast<uint64_t>(braking), static_cast<uint64_t>(jerk));
  return Level{count, count * static_cast<uint64_t>(jerk)};
}

// `braking` is above zero and on or above the level.
bool fits(int64_t braking, const Level& level, int64_t velocity) {
  const Wide twice = multiply(level.count + 1, 2 * static_cast<uint64_t>(braking) - level.braking);
  return twice.high == 0 && twice.low <= 2 * static_cast<uint64_t>(velocity);
}

}  // namespace

bool can_let_go(int64_t braking, int64_t let_go_jerk, int64_t velocity) {
  return braking <= 0 || fits(braking, level_of(braking, let_go_jerk), velocity);
}

int64_t next_braking(int64_t velocity, int64_t braking, int64_t most, int64_t jerk, int64_t let_go_jerk) {
  const int64_t least = braking - jerk;
  const int64_t hardest = braking + jerk < most ? braking + jerk : most;
  if (hardest <= least) return least;
  if (hardest <= 0) return hardest;
  Level level = level_of(hardest, let_go_jerk);
  if (fits(hardest, level, velocity)) return hardest;
  // On the way down it is `least`, or what the rounding adds to it: that needs no division.
  for (;;) {
    const auto on_level = static_cast<int64_t>(level.braking);
    const int64_t above = on_level > least ? on_level : least + 1;
    if (fits(above, level, velocity)) break;
    if (on_level <= least) return least;
    level.count -= 1;
    level.braking -= static_cast<uint64_t>(let_go_jerk);
  }
  const uint64_t let_go_level = (level.count + 1) * level.braking / 2;
  const uint64_t rest = divide(static_cast<uint64_t>(velocity) - let_go_level, level.count + 1);
  return static_cast<int64_t>(level.braking + rest);
}

}  // namespace stillpoint
