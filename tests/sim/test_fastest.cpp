// SPDX-License-Identifier: Apache-2.0
#include "sim/fastest.hpp"

#include <algorithm>
#include <string>

#include "sim/refusal.hpp"
#include "tests/support/random_task.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::sim;

namespace {

constexpr double kTolerance = 0.05;

// The arm of Li 2017 and a move of reference.md, section 5.
struct PaperArm {
  FastestQuestion question{{}, {{{11.0, 0.11}, 1.0}}, {{11.0, 0.11}}, kTolerance};

  PaperArm() {
    question.task.distance_counts = 500000;
    question.task.limits = {2e6, 20e6, 20e6, 400e6};
  }

  static const FastestCandidate& find(const FastestAnswer& answer, const std::string& name) {
    const auto is_it = [&](const FastestCandidate& each) { return each.name == name; };
    const auto found = std::find_if(answer.candidates.begin(), answer.candidates.end(), is_it);
    TEST_ASSERT_TRUE(found != answer.candidates.end());
    return *found;
  }
};

}  // namespace

TEST_F(PaperArm, the_soonest_is_first_and_within_two_percent_of_what_any_command_needs) {
  const FastestAnswer answer = find_fastest(question);
  const FastestCandidate& best = answer.candidates.front();
  TEST_ASSERT_TRUE(best.stream.within_limits);
  TEST_ASSERT_AT_LEAST_INT64(405, best.still_ticks.value());
  TEST_ASSERT_AT_MOST_INT64(407, best.still_ticks.value());
  for (const FastestCandidate& each : answer.candidates) {
    TEST_ASSERT_TRUE(!each.stream.within_limits || each.still_ticks.value() >= best.still_ticks.value());
  }
  // The recording is that of the first.
  TEST_ASSERT_EQUAL_UINT32(best.move_ticks, answer.best.report.total_ticks);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(500000), answer.best.setpoints.back());
}

TEST_F(PaperArm, every_shaper_of_the_family_is_tried_plainly_and_by_the_streams_limits) {
  const FastestAnswer answer = find_fastest(question);
  TEST_ASSERT_EQUAL_UINT32(446, find(answer, "s-curve + zv:11:0.11").still_ticks.value());
  TEST_ASSERT_EQUAL_UINT32(426, find(answer, "s-curve + zv:11:0.11, zero delay").still_ticks.value());
  for (uint32_t i = 1; i < kShaperKinds; ++i) {
    const auto kind = static_cast<ShaperKind>(i);
    if (kind == ShaperKind::kCustom) continue;
    const std::string name = "s-curve + " + spec_text(shaper_spec(kind, {11.0, 0.11}));
    const FastestCandidate& plain = find(answer, name);
    const FastestCandidate& zero_delay = find(answer, name + ", zero delay");
    TEST_ASSERT_TRUE(plain.stream.within_limits && zero_delay.stream.within_limits);
    TEST_ASSERT_AT_MOST_INT64(plain.move_ticks, zero_delay.move_ticks);
  }
}

// The plain move is still when its vibration has died down to the tolerance, no earlier and no later.
TEST_F(PaperArm, without_a_shaper_the_wait_counts) {
  const FastestAnswer answer = find_fastest(question);
  const FastestCandidate& plain = find(answer, "s-curve");
  TEST_ASSERT_EQUAL_UINT32(400, plain.move_ticks);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, plain.residual_ratio);
  // exp(-zeta w t) = 0.05: 394 ms from the peak, which comes within half a wave, 46 ms; the last half wave above the
  // tolerance ends at most as long before.
  TEST_ASSERT_AT_MOST_INT64(400 + 394 + 46, plain.still_ticks.value());
  TEST_ASSERT_AT_LEAST_INT64(400 + 394 - 46, plain.still_ticks.value());
}

TEST_F(PaperArm, a_mode_designed_for_that_is_not_the_arms_costs_time) {
  const uint32_t right = find_fastest(question).candidates.front().still_ticks.value();
  question.modes = {{13.0, 0.11}};
  const uint32_t wrong = find_fastest(question).candidates.front().still_ticks.value();
  TEST_ASSERT_AT_LEAST_INT64(right + 1, wrong);
}

TEST_F(PaperArm, a_trapezoid_stays_a_trapezoid) {
  question.task.profile.kind = ProfileKind::kTrapezoid;
  const FastestAnswer answer = find_fastest(question);
  for (const FastestCandidate& each : answer.candidates) {
    TEST_ASSERT_TRUE(each.combination.profile.kind == ProfileKind::kTrapezoid);
  }
  TEST_ASSERT_AT_MOST_INT64(*find(answer, "trapezoid + zv:11:0.11").still_ticks,
                            answer.candidates.front().still_ticks.value());
}

TEST_F(PaperArm, what_the_axis_refuses_is_refused) {
  question.task.limits.velocity = -1.0;
  bool refused = false;
  try {
    static_cast<void>(find_fastest(question));
  } catch (const Refusal&) {
    refused = true;
  }
  TEST_ASSERT_TRUE(refused);
}

TEST(two_modes_are_never_slower_than_a_zv_for_each) {
  const std::vector<Mode> modes = {{11.0, 0.11}, {27.0, 0.02}};
  FastestQuestion question{{}, {{modes[0], 0.6}, {modes[1], 0.4}}, modes, kTolerance};
  question.task.distance_counts = -100000;
  question.task.limits = {2e6, 20e6, 15e6, 800e6};
  const FastestAnswer answer = find_fastest(question);
  const auto zv = std::find_if(answer.candidates.begin(), answer.candidates.end(), [](const FastestCandidate& each) {
    return each.name == "s-curve + zv:11:0.11+zv:27:0.02";
  });
  TEST_ASSERT_TRUE(zv != answer.candidates.end());
  TEST_ASSERT_AT_MOST_INT64(zv->still_ticks.value() - 1, answer.candidates.front().still_ticks.value());
}
