// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/tracker.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

constexpr Mode kModes[] = {{11.0, 0.05}, {29.0, 0.02}};

// About normal: twelve uniform ones.
double normal(Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.unit();
  return sum;
}

// What a record says of an arm, as sure as it says.
Identification heard(const Mode& mode, double frequency_std_hz, double damping_std, Random& random) {
  Identification found{};
  found.finding = Finding::kFound;
  found.mode_count = 1;
  found.mode[0].frequency_hz = mode.frequency_hz + frequency_std_hz * normal(random);
  found.mode[0].damping_ratio = mode.damping_ratio + damping_std * normal(random);
  found.mode[0].frequency_std_hz = frequency_std_hz;
  found.mode[0].damping_std = damping_std;
  found.mode[0].confidence = 0.9;
  return found;
}

struct Following {
  ModeTracker tracker;
  Following() {
    tracker.begin(kModes, 2);
    tracker.enable(true);
  }
  double frequency(size_t k = 0) const { return tracker.mode(k).frequency_hz; }
  double damping(size_t k = 0) const { return tracker.mode(k).damping_ratio; }
};

}  // namespace

TEST(a_tracker_is_off_until_it_is_asked) {
  Random random(1);
  ModeTracker tracker;
  TEST_ASSERT_EQUAL_UINT32(0, tracker.count());
  tracker.begin(kModes, 2);
  TEST_ASSERT_FALSE(tracker.follow(heard({11.02, 0.05}, 0.01, 0.001, random)));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 11.0, tracker.mode(0).frequency_hz);
}

TEST_F(Following, a_drifting_arm_is_followed) {
  Random random(2);
  Mode arm = kModes[0];
  for (int i = 0; i < 150; ++i) {
    arm.frequency_hz *= 0.999;
    arm.damping_ratio *= 1.002;
    TEST_INFO(record, i);
    static_cast<void>(tracker.follow(heard(arm, 0.01, 0.001, random)));
    TEST_ASSERT_DOUBLE_RELATIVE(0.005, arm.frequency_hz, frequency());
    TEST_ASSERT_DOUBLE_RELATIVE(0.1, arm.damping_ratio, damping());
  }
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 29.0, frequency(1));
}

TEST_F(Following, a_still_arm_is_known_better_than_by_one_record) {
  Random random(3);
  constexpr double kDeviation = 0.2;
  double squares = 0.0;
  for (int i = 0; i < 400; ++i) {
    static_cast<void>(tracker.follow(heard(kModes[0], kDeviation, 0.02, random)));
    const double error = frequency() - kModes[0].frequency_hz;
    squares += error * error;
  }
  TEST_ASSERT_AT_MOST_DOUBLE(0.35 * kDeviation * 0.35 * kDeviation, squares / 400.0);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.05, damping());
}

TEST_F(Following, an_outlier_is_left_out_and_a_change_is_believed_in_the_end) {
  Random random(4);
  for (int i = 0; i < 20; ++i) static_cast<void>(tracker.follow(heard(kModes[0], 0.01, 0.001, random)));
  const double before = frequency();
  TEST_ASSERT_FALSE(tracker.follow(heard({12.1, 0.05}, 0.01, 0.001, random)));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, before, frequency());
  TEST_ASSERT_EQUAL_UINT32(1, tracker.left_out());
  for (int i = 0; i < 20; ++i) static_cast<void>(tracker.follow(heard({12.1, 0.05}, 0.01, 0.001, random)));
  TEST_ASSERT_DOUBLE_RELATIVE(0.002, 12.1, frequency());
}

TEST_F(Following, noise_does_not_carry_it_beyond_its_bounds) {
  // Records that find whatever there is, anywhere, as sure or unsure as they like.
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    TEST_INFO(seed, seed);
    Random random(seed);
    tracker.begin(kModes, 2);
    tracker.enable(true);
    for (int i = 0; i < 200; ++i) {
      const Mode anything{random.between(1.0, 60.0), random.between(0.0, 0.5)};
      static_cast<void>(tracker.follow(heard(anything, random.between(1e-4, 5.0), random.between(1e-5, 0.3), random)));
      for (size_t k = 0; k < 2; ++k) {
        TEST_ASSERT_DOUBLE_RELATIVE(0.2 + 1e-12, kModes[k].frequency_hz, frequency(k));
        TEST_ASSERT_DOUBLE_RELATIVE(0.8 + 1e-12, kModes[k].damping_ratio, damping(k));
      }
    }
  }
}

TEST_F(Following, what_is_not_found_or_not_sure_changes_nothing) {
  Random random(5);
  Identification found = heard({11.02, 0.05}, 0.01, 0.001, random);
  found.mode[0].confidence = 0.3;
  TEST_ASSERT_FALSE(tracker.follow(found));
  found = heard({11.02, 0.05}, 0.01, 0.001, random);
  found.finding = Finding::kNoisy;
  TEST_ASSERT_FALSE(tracker.follow(found));
  found = heard({17.0, 0.05}, 0.01, 0.001, random);  // nobody's
  TEST_ASSERT_FALSE(tracker.follow(found));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 11.0, frequency());
  TEST_ASSERT_EQUAL_UINT32(0, tracker.left_out());
}
