// SPDX-License-Identifier: Apache-2.0
// Instructions of every kind of profile: planning the reference move, making its track, and a tick of it. See
// counting.hpp.
#include "shaper/profile/matched.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/profile/track.hpp"
#include "tests/bench/counting.hpp"
#include "tests/bench/scenarios.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;

constexpr int64_t kCubicNodes[] = {0, 0, kTableOne, 0};
constexpr ProfileTable kCubic = {1, 1, kCubicNodes, {1.5, 6.0, 6.0, 12.0}};

struct NamedKind {
  const char* name;
  ProfileKind kind;
};
constexpr NamedKind kKinds[] = {{"trapezoid", ProfileKind::kTrapezoid}, {"s-curve", ProfileKind::kSCurve},
                                {"sin2", ProfileKind::kSin2},           {"poly5", ProfileKind::kPoly5},
                                {"poly7", ProfileKind::kPoly7},         {"cubic table", ProfileKind::kTable},
                                {"matched", ProfileKind::kMatched}};

Track track;

TEST_F(Counting, every_kind_of_profile_is_counted) {
  print("\ninstructions over the reference move: once, and of Sampler::tick\n");
  print_left("kind", 16), print("      plan     track     least      mean      most\n");
  for (const NamedKind& kind : kKinds) {
    Plan plan{};
    Count planning, making, ticks;
    measure(planning, [&] {
      TEST_ASSERT_OK(
          plan_rest_to_rest(1.7e6, kLimits, kind.kind, kTickS, plan, ProfileDetail{&kCubic, 11.0, 0.11, plan_matched}));
    });
    measure(making, [&] { Track::make(plan, 0, signal_from_counts(1700000), track); });
    Sampler sampler;
    sampler.begin(track);
    while (!sampler.at_rest()) measure(ticks, [&] { static_cast<void>(sampler.tick()); });
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), sampler.position());
    print_left(kind.name, 16);
    print_right(planning.most(), 10);
    print_right(making.most(), 10);
    print_right(ticks.least(), 10);
    print_right(ticks.mean(), 10);
    print_right(ticks.most(), 10);
    print("\n");
    TEST_ASSERT_AT_MOST_INT64(2000, ticks.most());  // of 168,000 that a tick has
  }
}

}  // namespace
