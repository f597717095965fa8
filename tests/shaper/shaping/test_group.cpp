// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/group.hpp"

#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;
constexpr size_t kCapacity = 1024;
LineSample line_memory[kCapacity];

ShaperDesign designed(ShaperKind kind, double frequency_hz, double damping_ratio) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(kind, Mode{frequency_hz, damping_ratio}, kTick, design));
  return design;
}

void add(ShaperKind kind, double frequency_hz, ShaperDesign& design) {
  TEST_ASSERT_OK(add_shaper(kind, Mode{frequency_hz, 0.0}, kTick, design));
}

bool same(const ShaperDesign& a, const ShaperDesign& b) {
  if (a.stage_count != b.stage_count || a.tap_count != b.tap_count) return false;
  for (uint32_t i = 0; i < a.tap_count; ++i) {
    if (a.taps[i].delay_ticks != b.taps[i].delay_ticks || a.taps[i].gain != b.taps[i].gain) return false;
  }
  return true;
}

// Every stage as Stage promises: taps in a row from delay 0, an odd count, gains that sum to one.
void check_stages(const ShaperDesign& design) {
  uint32_t taps = 0;
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    const Stage& stage = design.stages[i];
    TEST_ASSERT_EQUAL_UINT32(taps, stage.first_tap);
    TEST_ASSERT_EQUAL_UINT32(1, stage.tap_count % 2);
    TEST_ASSERT_EQUAL_UINT32(0, design.taps[taps].delay_ticks);
    int64_t sum = 0;
    for (uint32_t k = taps; k < taps + stage.tap_count; ++k) {
      sum += design.taps[k].gain;
      if (k > taps) TEST_ASSERT_AT_LEAST_INT64(design.taps[k - 1].delay_ticks, design.taps[k].delay_ticks);
    }
    TEST_ASSERT_EQUAL_INT64(kUnityGain, sum);
    taps += stage.tap_count;
  }
  TEST_ASSERT_EQUAL_UINT32(taps, design.tap_count);
}

struct PathOfThreeAxes {
  ShaperDesign each[3] = {designed(ShaperKind::kZv, 11.0, 0.11), designed(ShaperKind::kZvd, 37.3, 0.02),
                          ShaperDesign{}};
};

}  // namespace

TEST_F(PathOfThreeAxes, the_common_shaper_has_the_stages_of_all) {
  ShaperDesign common{};
  TEST_ASSERT_OK(common_shaper(each, 3, common));
  check_stages(common);
  TEST_ASSERT_EQUAL_UINT32(3, common.stage_count);
  TEST_ASSERT_EQUAL_UINT32(each[0].length_ticks() + each[1].length_ticks(), common.length_ticks());
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, each[0].delay_ticks() + each[1].delay_ticks(), common.delay_ticks());
}

TEST(stages_that_axes_share_are_taken_once_and_those_of_one_axis_all) {
  ShaperDesign each[3] = {designed(ShaperKind::kZv, 11.0, 0.0), designed(ShaperKind::kZvd, 11.0, 0.0), ShaperDesign{}};
  add(ShaperKind::kZv, 21.0, each[0]);
  add(ShaperKind::kZv, 21.0, each[2]);
  add(ShaperKind::kZvd, 11.0, each[2]);
  ShaperDesign common{};
  TEST_ASSERT_OK(common_shaper(each, 3, common));
  check_stages(common);
  // ZVD at 11 Hz, as the second and third axis need it, and ZV at 21 Hz
  TEST_ASSERT_EQUAL_UINT32(3, common.stage_count);
  TEST_ASSERT_EQUAL_UINT32(2 * 46 + 24, common.length_ticks());
  // Bit for bit: a mode that is off by little is another.
  each[2] = designed(ShaperKind::kZv, 11.0001, 0.0);
  TEST_ASSERT_OK(common_shaper(each, 3, common));
  TEST_ASSERT_EQUAL_UINT32(4, common.stage_count);
}

TEST_F(PathOfThreeAxes, the_common_shaper_may_take_the_place_of_an_axis_and_then_adds_nothing) {
  ShaperDesign common{};
  TEST_ASSERT_OK(common_shaper(each, 3, common));
  TEST_ASSERT_OK(common_shaper(each, 3, each[1]));
  TEST_ASSERT_TRUE(same(common, each[1]));
  TEST_ASSERT_OK(common_shaper(each, 2, common));
  TEST_ASSERT_EQUAL_UINT32(3, common.stage_count);
  TEST_ASSERT_OK(common_shaper(nullptr, 0, common));
  TEST_ASSERT_EQUAL_UINT32(0, common.stage_count);
}

TEST(a_common_shaper_without_room_is_refused_and_nothing_changes) {
  ShaperDesign each[2] = {};
  for (uint32_t i = 0; i < ShaperDesign::kMaxStages; ++i) {
    add(ShaperKind::kZv, 10.0 + i, each[0]);
    add(ShaperKind::kZv, 50.0 + i, each[1]);
  }
  ShaperDesign common = designed(ShaperKind::kZv, 11.0, 0.0);
  const Status status = common_shaper(each, 2, common);
  TEST_ASSERT_REFUSED(kTooManyStages, kStages, status);
  TEST_ASSERT_DOUBLE_WITHIN(0, 2.0 * ShaperDesign::kMaxStages, status.value);
  TEST_ASSERT_EQUAL_UINT32(1, common.stage_count);
  each[1] = each[0];
  TEST_ASSERT_OK(common_shaper(each, 2, common));
  TEST_ASSERT_TRUE(same(each[0], common));
}

TEST_F(PathOfThreeAxes, equalised_delays_agree_exactly) {
  const double slowest = each[1].delay_ticks();  // ZVD of 37.3 Hz: 13 ticks, ZV of 11 Hz: 19
  TEST_ASSERT_TRUE(slowest < each[0].delay_ticks());
  TEST_ASSERT_OK(equalise_delays(each, 3));
  int64_t delays[3] = {};
  for (int i = 0; i < 3; ++i) {
    check_stages(each[i]);
    for (uint32_t k = 0; k < each[i].tap_count; ++k) {
      delays[i] += static_cast<int64_t>(each[i].taps[k].gain) * each[i].taps[k].delay_ticks;
    }
  }
  TEST_ASSERT_EQUAL_INT64(delays[0], delays[1]);
  TEST_ASSERT_EQUAL_INT64(delays[0], delays[2]);
  const uint32_t stages[] = {1, 3, 1};
  for (int i = 0; i < 3; ++i) TEST_ASSERT_EQUAL_UINT32(stages[i], each[i].stage_count);
  TEST_ASSERT_OK(equalise_delays(each, 3));
  for (int i = 0; i < 3; ++i) TEST_ASSERT_EQUAL_UINT32(stages[i], each[i].stage_count);
}

TEST(a_whole_delay_takes_no_tick_of_line_too_many) {
  ShaperDesign each[2] = {};
  each[0].stage_count = 1;
  each[0].tap_count = 3;
  each[0].stages[0] = Stage{0, 3};
  each[0].taps[0] = Tap{0, 0};
  each[0].taps[1] = Tap{6, 0};
  each[0].taps[2] = Tap{7, kUnityGain};
  TEST_ASSERT_OK(equalise_delays(each, 2));
  TEST_ASSERT_TRUE(same(each[0], each[1]));
  each[0].taps[1] = Tap{0, 0};
  each[0].taps[2] = Tap{1, kUnityGain};
  each[1] = ShaperDesign{};
  TEST_ASSERT_OK(equalise_delays(each, 2));
  TEST_ASSERT_TRUE(same(each[0], each[1]));
  TEST_ASSERT_EQUAL_UINT32(1, each[1].length_ticks());
}

TEST(axes_without_room_for_a_delay_are_refused_and_none_changes) {
  ShaperDesign each[3] = {designed(ShaperKind::kZv, 0.6, 0.0), ShaperDesign{}, ShaperDesign{}};
  for (uint32_t i = 0; i < ShaperDesign::kMaxStages; ++i) add(ShaperKind::kZv, 300.0, each[2]);
  TEST_ASSERT_REFUSED(kTooManyStages, kStages, equalise_delays(each, 3));
  TEST_ASSERT_EQUAL_UINT32(0, each[1].stage_count);
  TEST_ASSERT_OK(equalise_delays(each, 2));
  each[0] = designed(ShaperKind::kZv, 5e-4, 0.0);
  for (int i = 0; i < 3; ++i) add(ShaperKind::kZv, 5e-4, each[0]);
  TEST_ASSERT_REFUSED(kAboveMaximum, kDelay, equalise_delays(each, 2));
  TEST_ASSERT_EQUAL_UINT32(1, each[1].stage_count);
  TEST_ASSERT_OK(equalise_delays(nullptr, 0));
}

TEST_F(PathOfThreeAxes, equalised_axes_lag_alike_at_constant_velocity) {
  TEST_ASSERT_OK(equalise_delays(each, 3));
  Shaper shapers[3];
  uint32_t taken = 0;
  for (int i = 0; i < 3; ++i) {
    TEST_ASSERT_OK(shapers[i].configure(each[i], line_memory + taken, kCapacity - taken, 0));
    taken += static_cast<uint32_t>(Shaper::memory_needed(each[i]));
  }
  for (int tick = 1; tick <= 200; ++tick) {
    Signal out[3];
    for (int i = 0; i < 3; ++i) out[i] = shapers[i].tick(tick * INT64_C(123456789012));
    if (tick < 100) continue;  // the longest is 46
    for (int i = 1; i < 3; ++i) {
      TEST_ASSERT_AT_MOST_INT64(4, out[i] - out[0]);  // half an LSB a stage on either side
      TEST_ASSERT_AT_LEAST_INT64(-4, out[i] - out[0]);
    }
  }
}

TEST_F(PathOfThreeAxes, the_cost_of_a_group_is_the_slowest_axis_and_all_lines) {
  const ShaperCost zv = cost_of(each[0]);
  TEST_ASSERT_EQUAL_UINT32(46, zv.length_ticks);
  TEST_ASSERT_EQUAL_UINT32(47, zv.line_signals);
  TEST_ASSERT_EQUAL_UINT32(3, zv.taps_per_tick);
  const ShaperCost group = cost_of(each, 3);
  TEST_ASSERT_DOUBLE_WITHIN(0, each[0].delay_ticks(), group.delay_ticks);
  TEST_ASSERT_EQUAL_UINT32(46, group.length_ticks);
  TEST_ASSERT_EQUAL_UINT32(47 + 2 * 15, group.line_signals);
  TEST_ASSERT_EQUAL_UINT32(9, group.taps_per_tick);
}

TEST_F(PathOfThreeAxes, a_common_shaper_leaves_no_lag_and_equal_delays_none_that_is_steady) {
  ContourLag plain{};
  TEST_ASSERT_OK(worst_lag(each, 3, line_memory, kCapacity, plain));
  // Between the 11 Hz axis and the one without a shaper, whose response is never behind: their delays apart.
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, each[0].delay_ticks(), plain.worst_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, each[0].delay_ticks(), plain.corner_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, each[0].delay_ticks(), plain.steady_ticks);
  TEST_ASSERT_EQUAL_UINT32(0, plain.first_axis);
  TEST_ASSERT_EQUAL_UINT32(2, plain.second_axis);

  ShaperDesign equalised[3] = {each[0], each[1], each[2]};
  TEST_ASSERT_OK(equalise_delays(equalised, 3));
  ContourLag equal{};
  TEST_ASSERT_OK(worst_lag(equalised, 3, line_memory, kCapacity, equal));
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, equal.steady_ticks);
  TEST_ASSERT_AT_LEAST_DOUBLE(22.0, equal.worst_ticks);  // a ZV of 11 Hz against a pure delay: 2 0.586 0.414 46 ticks
  TEST_ASSERT_AT_MOST_DOUBLE(22.6, equal.worst_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, equal.worst_ticks, 2.0 * equal.corner_ticks);  // behind, then ahead by as much

  ShaperDesign common[3] = {};
  TEST_ASSERT_OK(common_shaper(each, 3, common[0]));
  common[1] = common[2] = common[0];
  ContourLag none{1.0, 1.0, 1.0, 1, 1};
  TEST_ASSERT_OK(worst_lag(common, 3, line_memory, kCapacity, none));
  TEST_ASSERT_DOUBLE_WITHIN(0, 0.0, none.worst_ticks);
  TEST_ASSERT_DOUBLE_WITHIN(0, 0.0, none.corner_ticks);
}

TEST_F(PathOfThreeAxes, a_velocity_that_switches_reaches_the_worst_lag) {
  TEST_ASSERT_OK(equalise_delays(each, 3));
  ContourLag lag{};
  TEST_ASSERT_OK(worst_lag(each, 2, line_memory, kCapacity, lag));
  Shaper first;
  Shaper second;
  const size_t taken = Shaper::memory_needed(each[0]);
  const uint32_t length = each[0].length_ticks() + each[1].length_ticks();
  int32_t sign[256] = {};
  TEST_ASSERT_TRUE(length < 256);
  TEST_ASSERT_OK(first.configure(each[0], line_memory, taken, 0));
  TEST_ASSERT_OK(second.configure(each[1], line_memory + taken, kCapacity - taken, 0));
  for (uint32_t i = 0; i <= length; ++i) {
    const Signal step = INT64_C(1) << 40;
    sign[i] = first.tick(step) > second.tick(step) ? 1 : -1;
  }
  first.fill(0);
  second.fill(0);
  Signal position = 0;
  Signal apart = 0;
  const Signal velocity = INT64_C(1) << 40;  // a tick
  for (uint32_t i = 0; i <= length; ++i) {
    position += sign[length - i] * velocity;
    apart = first.tick(position) - second.tick(position);
  }
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, lag.worst_ticks, static_cast<double>(apart) / static_cast<double>(velocity));
}

TEST_F(PathOfThreeAxes, a_memory_too_short_for_two_shapers_is_refused) {
  ContourLag lag{5.0, 5.0, 5.0, 0, 0};
  const size_t needed = (4 + 47) + (8 + 2 * 15);  // each 3-tap stage and its line
  const Status status = worst_lag(each, 2, line_memory, needed - 1, lag);
  TEST_ASSERT_REFUSED(kLineTooShort, kDelay, status);
  TEST_ASSERT_DOUBLE_WITHIN(0, static_cast<double>(needed), status.value);
  TEST_ASSERT_DOUBLE_WITHIN(0, 5.0, lag.worst_ticks);
  TEST_ASSERT_OK(worst_lag(each, 2, line_memory, needed, lag));
}
