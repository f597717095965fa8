// SPDX-License-Identifier: Apache-2.0
// The modes in force followed from move to move, from a client's side.
#include "tests/firmware/tracking_rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr int kDriftMoves = 200;

struct Drift {
  double worst_part = 0.0;  // of the tracked frequency from the arm's
  double first = 0.0;       // ringing of the first moves, of the last, the largest; units
  double last = 0.0;
  double largest = 0.0;
  uint32_t used = 0;
  uint32_t applied = 0;
};

// 10 % down or up in kDriftMoves.
Drift drift(uint64_t seed, uint32_t how) {
  TrackingRig rig;
  Random random(seed);
  rig.track(how);
  const double to = random.integer(0, 1) == 0 ? 0.9 : 1.1;
  Drift result;
  double hz = kArmHz;
  uint32_t length = rig.axis.shaper().length_ticks();
  for (int i = 0; i < kDriftMoves; ++i) {
    hz *= std::pow(to, 1.0 / kDriftMoves);
    rig.arm.become({hz, kArmDamping});
    const double ringing = rig.move_somewhere(random, 1000);
    if (how != kOff) result.worst_part = std::fmax(result.worst_part, std::fabs(rig.tracked_hz() - hz) / hz);
    if (i < 10) result.first = std::fmax(result.first, ringing);
    if (i >= kDriftMoves - 10) result.last = std::fmax(result.last, ringing);
    result.largest = std::fmax(result.largest, ringing);
    result.applied += rig.axis.shaper().length_ticks() != length ? 1U : 0U;
    length = rig.axis.shaper().length_ticks();
  }
  result.used = rig.used();
  return result;
}

TEST(an_arm_that_drifts_is_followed_and_stays_still) {
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    TEST_INFO(seed, seed);
    const Drift left = drift(seed, kOff);
    const Drift applied = drift(seed, kApply);
    MESSAGE("off by at most ", 100.0 * applied.worst_part, " %; ringing at the end ", left.last, " left alone, ",
            applied.last, " followed; ", applied.used, " records used, ", applied.applied, " designs");
    TEST_ASSERT_AT_MOST_DOUBLE(0.02, applied.worst_part);
    TEST_ASSERT_AT_LEAST_DOUBLE(5.0 * left.first, left.last);
    TEST_ASSERT_AT_MOST_DOUBLE(0.25 * left.last, applied.largest);
  }
}

TEST_F(TrackingRig, it_is_off_by_default) {
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0250));
  Random random(1);
  arm.become({10.5, kArmDamping});
  for (int i = 0; i < 3; ++i) move_somewhere(random);
  TEST_ASSERT_EQUAL_UINT32(0, tune_memory.holder);
  for (uint32_t address = 0x0250; address < 0x0258; ++address) TEST_ASSERT_EQUAL_UINT32(0, get(address));
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x0260));
}

TEST_F(TrackingRig, what_it_follows_is_shown_and_not_applied_unless_it_is_to_be) {
  Random random(2);
  track(kShow);
  TEST_ASSERT_EQUAL_UINT32(110000, get_wide(0x0260));  // before anything is heard, as it was applied
  TEST_ASSERT_EQUAL_UINT32(4000, get(0x0262));
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x0264));
  const uint32_t length = axis.shaper().length_ticks();
  arm.become({10.7, kArmDamping});
  for (int i = 0; i < 12; ++i) move_somewhere(random);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 10.7, tracked_hz());
  TEST_ASSERT_DOUBLE_WITHIN(0.1 * kArmDamping, kArmDamping, tracked_damping());
  TEST_ASSERT_AT_LEAST_INT64(10, used());
  TEST_ASSERT_EQUAL_UINT32(110000, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(length, axis.shaper().length_ticks());
  track(kOff);
  for (int i = 0; i < 2; ++i) move_somewhere(random);
  TEST_ASSERT_EQUAL_UINT32(0, tune_memory.holder);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 10.7, tracked_hz());  // what it last was
  track(kApply);
  TEST_ASSERT_EQUAL_UINT32(110000, get_wide(0x0260));  // begun anew
  TEST_ASSERT_EQUAL_UINT32(0, used());
  for (int i = 0; i < 12; ++i) move_somewhere(random);
  TEST_ASSERT_DOUBLE_WITHIN(600.0, 107000.0, get_wide(0x0102));  // staged and in force, in the set that was
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_TRUE(axis.shaper().length_ticks() != length);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0012));
}

// Its tip moves with its motor: nothing but noise.
TEST(noise_moves_nothing) {
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    TEST_INFO(seed, seed);
    TrackingRig rig;
    Random random(seed);
    rig.arm.config.accelerometer.seed = 1000 * seed;
    rig.arm.become({kArmHz, kArmDamping}, 1e-9);
    rig.track(kApply);
    const uint32_t length = rig.axis.shaper().length_ticks();
    for (int i = 0; i < 300; ++i) rig.move_somewhere(random);
    TEST_ASSERT_EQUAL_UINT32(0, rig.used());
    TEST_ASSERT_AT_LEAST_INT64(290, rig.unheard());
    TEST_ASSERT_EQUAL_UINT32(110000, rig.get_wide(0x0260));
    TEST_ASSERT_EQUAL_UINT32(4000, rig.get(0x0262));
    TEST_ASSERT_EQUAL_UINT32(length, rig.axis.shaper().length_ticks());
  }
}

TEST_F(TrackingRig, an_outlier_is_left_out) {
  Random random(3);
  track(kShow);
  arm.become({10.9, kArmDamping});
  for (int i = 0; i < 8; ++i) move_somewhere(random);
  const double before = tracked_hz();
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 10.9, before);
  arm.become({12.4, kArmDamping});
  move_somewhere(random);
  TEST_ASSERT_EQUAL_UINT32(1, left_out());
  TEST_ASSERT_DOUBLE_WITHIN(0.0, before, tracked_hz());
  arm.become({10.9, kArmDamping});
  for (int i = 0; i < 4; ++i) move_somewhere(random);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 10.9, tracked_hz());
}

TEST_F(TrackingRig, it_goes_on_in_the_set_in_force_and_begins_anew_with_another) {
  Random random(10);
  track(kApply);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 5));  // another is shown
  arm.become({10.6, kArmDamping});
  for (int i = 0; i < 8; ++i) move_somewhere(random);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0100));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 0));
  TEST_ASSERT_DOUBLE_WITHIN(500.0, 106000.0, get_wide(0x0102));
  TEST_ASSERT_AT_LEAST_INT64(5, used());
  apply_zv(12.0, 0.02, 3);
  step(3);
  TEST_ASSERT_EQUAL_UINT32(120000, get_wide(0x0260));
  TEST_ASSERT_EQUAL_UINT32(2000, get(0x0262));
  TEST_ASSERT_EQUAL_UINT32(0, used());
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 0));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(3);
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x0260));  // no shaper, no modes
  for (int i = 0; i < 2; ++i) move_somewhere(random);
  TEST_ASSERT_EQUAL_UINT32(0, used() + unheard());
}

TEST_F(TrackingRig, two_modes_are_followed_each_by_itself) {
  Random random(11);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0068, 6000000));  // a jerk that shakes both
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {2, 0, 110000 >> 16, 110000 & 0xFFFF, 4000, 0, 1}));
  TEST_ASSERT_EQUAL_UINT32(0, write(0x010A, {290000 >> 16, 290000 & 0xFFFF, 2000, 0, 1}));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(50);
  track(kApply);
  TEST_ASSERT_EQUAL_UINT32(290000, get_wide(0x0264));
  for (int i = 0; i < 60; ++i) {
    arm.config.modes = {{{11.0 * (1.0 + 0.0005 * i), 0.04}, 0.9}, {{29.0 * (1.0 - 0.0008 * i), 0.02}, 0.1}};
    arm.change();
    move_somewhere(random);
  }
  TEST_ASSERT_DOUBLE_RELATIVE(0.02, 11.0 * 1.0295, tracked_hz());
  TEST_ASSERT_DOUBLE_RELATIVE(0.02, 29.0 * 0.9528, 1e-4 * get_wide(0x0264));
  TEST_ASSERT_AT_MOST_INT64(285000, get_wide(0x010A));  // and both are in force
  TEST_ASSERT_AT_LEAST_INT64(111000, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
}

// Without an accelerometer: a motor that its arm moves by a twentieth of what the tip swings.
TEST_F(TrackingRig, the_following_error_alone_tells_it) {
  Random random(12);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x020C, 2));
  arm.config.reaction = 0.05;
  arm.config.encoder.noise_counts = 1.0;
  arm.become({10.9, kArmDamping});
  track(kShow);
  for (int i = 0; i < 12; ++i) move_somewhere(random);
  TEST_ASSERT_DOUBLE_WITHIN(0.03, 10.9, tracked_hz());
  TEST_ASSERT_AT_LEAST_INT64(8, used());
}

TEST_F(TrackingRig, a_record_with_the_sensor_at_its_end_or_with_gaps_moves_nothing) {
  Random random(13);
  arm.become({10.8, kArmDamping});
  TEST_ASSERT_EQUAL_UINT32(0, write(0x024A, {0xFFFF, 0xFFF6, 0, 10}));  // a few steps: the least ringing is beyond
  track(kShow);
  for (int i = 0; i < 3; ++i) move_somewhere(random);
  TEST_ASSERT_EQUAL_UINT32(0, heard());
  TEST_ASSERT_AT_LEAST_INT64(2, unheard());
  TEST_ASSERT_EQUAL_UINT32(0, write(0x024A, {0, 0, 0, 0}));
  move_somewhere(random);  // the one that was armed before
  const uint32_t before = unheard();
  arm.lost_every = 60;
  for (int i = 0; i < 3; ++i) move_somewhere(random);
  TEST_ASSERT_EQUAL_UINT32(0, heard());
  TEST_ASSERT_AT_LEAST_INT64(before + 2, unheard());
  arm.lost_every = 0;
  for (int i = 0; i < 3; ++i) move_somewhere(random);
  TEST_ASSERT_AT_LEAST_INT64(2, heard());
}

}  // namespace
