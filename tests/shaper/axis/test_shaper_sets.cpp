// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/shaper_sets.hpp"

#include "shaper/axis/axis.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;
const AxisLimits kMaximum{2e6, 40e6, 40e6, 2e9};

ShaperDesign designed(double frequency_hz) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{frequency_hz, 0.05}, kTick, design));
  return design;
}

// Empty gripper, full gripper, no shaper.
struct AxisWithThreeLoads {
  Axis<256> axis = {};
  ShaperSets<4> sets = {};

  AxisWithThreeLoads() {
    TEST_ASSERT_OK(axis.configure(AxisConfig{kTick, kMaximum, 40e6, 2e9}));
    TEST_ASSERT_OK(sets.store(0, designed(11.0)));
    TEST_ASSERT_OK(sets.store(1, designed(7.0)));
    TEST_ASSERT_OK(sets.store(3, ShaperDesign{}));
  }

  void select(uint32_t index) {
    TEST_ASSERT_OK(sets.select(index, axis));
    axis.tick();
    TEST_ASSERT_EQUAL_UINT32(index, sets.in_force(axis));
  }
};

}  // namespace

TEST_F(AxisWithThreeLoads, a_selected_set_is_in_force_from_the_next_tick) {
  TEST_ASSERT_EQUAL_UINT32(3, sets.in_force(axis));  // the axis has no shaper, as that set
  TEST_ASSERT_OK(sets.select(1, axis));
  TEST_ASSERT_EQUAL_UINT32(3, sets.in_force(axis));
  axis.tick(false);
  TEST_ASSERT_EQUAL_UINT32(3, sets.in_force(axis));
  axis.tick();
  TEST_ASSERT_EQUAL_UINT32(1, sets.in_force(axis));
  TEST_ASSERT_EQUAL_UINT32(designed(7.0).length_ticks(), axis.shaper().length_ticks());
  select(0);
  select(3);
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
}

TEST_F(AxisWithThreeLoads, empty_and_missing_sets_are_refused_by_name) {
  select(0);
  const Status empty = sets.select(2, axis);
  TEST_ASSERT_REFUSED(kNotAvailable, kNone, empty);
  TEST_ASSERT_DOUBLE_WITHIN(0, 2.0, empty.value);
  const Status missing = sets.select(4, axis);
  TEST_ASSERT_REFUSED(kAboveMaximum, kNone, missing);
  TEST_ASSERT_DOUBLE_WITHIN(0, 3.0, missing.accepted);
  TEST_ASSERT_REFUSED(kAboveMaximum, kNone, sets.store(4, ShaperDesign{}));
  TEST_ASSERT_REFUSED(kAboveMaximum, kNone, sets.select(UINT32_MAX, axis));
  TEST_ASSERT_FALSE(sets.stored(2));
  TEST_ASSERT_FALSE(sets.stored(4));
  TEST_ASSERT_FALSE(axis.pending());
  TEST_ASSERT_EQUAL_UINT32(0, sets.in_force(axis));
}

TEST_F(AxisWithThreeLoads, what_the_axis_refuses_leaves_its_set_in_force) {
  select(0);
  TEST_ASSERT_OK(sets.store(2, designed(1.0)));
  TEST_ASSERT_REFUSED(kLineTooShort, kDelay, sets.select(2, axis));
  TEST_ASSERT_OK(axis.command(Move{1000, ProfileKind::kSCurve, kMaximum, 0.0, false}, nullptr));
  axis.tick();
  TEST_ASSERT_REFUSED(kBusy, kNone, sets.select(1, axis));
  TEST_ASSERT_EQUAL_UINT32(0, sets.in_force(axis));
}

TEST_F(AxisWithThreeLoads, a_set_stored_over_is_not_in_force_before_it_is_selected) {
  select(0);
  TEST_ASSERT_OK(sets.store(0, designed(12.0)));
  TEST_ASSERT_EQUAL_UINT32(kNoShaperSet, sets.in_force(axis));
  TEST_ASSERT_EQUAL_UINT32(designed(11.0).length_ticks(), axis.shaper().length_ticks());
  select(0);
}

TEST_F(AxisWithThreeLoads, the_set_in_force_is_read_off_the_axis) {
  select(0);
  TEST_ASSERT_OK(axis.set_shaper(designed(9.0)));  // past the sets
  axis.tick();
  TEST_ASSERT_EQUAL_UINT32(kNoShaperSet, sets.in_force(axis));
  TEST_ASSERT_OK(axis.set_shaper(designed(7.0)));
  axis.tick();
  TEST_ASSERT_EQUAL_UINT32(1, sets.in_force(axis));
  // Of two that are the same, the one that was asked for.
  TEST_ASSERT_OK(sets.store(2, designed(7.0)));
  select(2);
  select(1);
}

TEST(a_set_without_anything_stored_is_in_force_nowhere) {
  Axis<16> axis = {};
  const ShaperSets<> sets = {};
  TEST_ASSERT_EQUAL_UINT32(kNoShaperSet, sets.in_force(axis));
}
