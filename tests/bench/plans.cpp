// SPDX-License-Identifier: Apache-2.0
// Instructions of a plan, of what makes it ready for the tick, and of a sample. See counting.hpp.
#include "shaper/profile/track.hpp"
#include "tests/bench/counting.hpp"
#include "tests/bench/scenarios.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;

constexpr int kTasks = 60;

TEST_F(Counting, plans_and_their_samples_are_counted) {
  print("\ninstructions over 60 random states and moves around the reference move's limits\n");
  print_left("", 16), print("     least      mean      most\n");
  static Track track;
  testing::Random random(1);
  Count rest, any, make, sample;
  for (int i = 0; i < kTasks; ++i) {
    const PlanTask task = random_plan_task(random);
    Plan plan{};
    Status status;
    measure(rest, [&] { status = plan_rest_to_rest(task.distance, task.limits, ProfileKind::kSCurve, kTickS, plan); });
    TEST_ASSERT_OK(status);
    measure(any, [&] { status = plan_from(task.start, task.distance, task.limits, kTickS, plan); });
    TEST_ASSERT_OK(status);
    const auto target = static_cast<int32_t>(task.distance);
    measure(make, [&] { Track::make(plan, 0, signal_from_counts(target), track); });
    Sampler sampler;
    sampler.begin(track);
    while (!sampler.at_rest()) measure(sample, [&] { static_cast<void>(sampler.tick()); });
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(target), sampler.position());
  }
  print_row("rest to rest", rest);
  print_row("any state", any);
  print_row("Track::make", make);
  print_row("Sampler::tick", sample);
  TEST_ASSERT_AT_LEAST_INT64(1000, rest.least());  // less is no plan: the count is wrong
  TEST_ASSERT_AT_LEAST_INT64(20, sample.least());
}

}  // namespace
