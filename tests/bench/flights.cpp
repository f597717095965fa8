// SPDX-License-Identifier: Apache-2.0
// Instructions of the background's commands: from rest, and in flight, where a plan that takes longer than its lead of
// four ticks comes too late and has to be made again.
#include "tests/bench/counting.hpp"
#include "tests/bench/scenarios.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;

Axis<kCapacity> axis;

Move to(int32_t target, const AxisLimits& limits = kLimits) {
  return Move{target, ProfileKind::kSCurve, limits, 0.0, false};
}

void run_to_rest() {
  do {
    static_cast<void>(axis.tick());
  } while (axis.state().phase != AxisPhase::kAtRest || axis.pending());
}

TEST_F(Counting, commands_are_counted) {
  ShaperDesign design{};
  TEST_ASSERT_OK(axis.configure(kAxis));
  TEST_ASSERT_OK(design_of(kScenarios[1], design));
  TEST_ASSERT_OK(axis.set_shaper(design));
  static_cast<void>(axis.tick());
  Count rest, flight, jog, halt;
  testing::Random random(1);
  for (int i = 0; i < 40; ++i) {
    const auto first = static_cast<int32_t>(random.integer(-2000000, 2000000));
    const auto second = static_cast<int32_t>(random.integer(-2000000, 2000000));
    measure(rest, [&] { TEST_ASSERT_OK(axis.command(to(first), nullptr)); });
    for (int64_t tick = random.integer(1, 600); tick > 0; --tick) static_cast<void>(axis.tick());
    if (axis.state().phase == AxisPhase::kAtRest) continue;
    measure(flight, [&] { TEST_ASSERT_OK(axis.command(to(second), nullptr)); });
    for (int64_t tick = random.integer(10, 600); tick > 0; --tick) static_cast<void>(axis.tick());
    measure(jog, [&] { TEST_ASSERT_OK(axis.jog(random.between(-1.2e6, 1.2e6), kLimits, nullptr)); });
    for (int64_t tick = random.integer(10, 600); tick > 0; --tick) static_cast<void>(axis.tick());
    measure(halt, [&] { TEST_ASSERT_OK(axis.halt(kLimits, nullptr)); });
    run_to_rest();
  }
  print("\ninstructions of a command\n");
  print_left("", 16), print("     least      mean      most\n");
  print_row("from rest", rest);
  print_row("in flight", flight);
  print_row("jog", jog);
  print_row("halt", halt);
  // Three and a half of the four ticks of a millisecond, at 168 MHz and two cycles each.
  TEST_ASSERT_AT_MOST_INT64(294000, flight.most());
}

}  // namespace
