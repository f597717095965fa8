// SPDX-License-Identifier: Apache-2.0
// A ZV shaper that lies in flash: the compiler's bits are those of add_shaper.
#include "shaper/shaping/quantise.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;
constexpr Mode kModes[] = {{11.0, 0.11}, {0.5, 0.0}, {37.3, 0.02}, {250.0, 0.3}, {490.0, 0.0}};
constexpr ShaperDesign kDesigns[] = {zv_design(kModes[0], kTick), zv_design(kModes[1], kTick),
                                     zv_design(kModes[2], kTick), zv_design(kModes[3], kTick),
                                     zv_design(kModes[4], kTick)};
constexpr uint32_t kCount = sizeof(kModes) / sizeof(kModes[0]);

// One stage of three taps at 0, k, k + 1 that are positive and sum to one.
constexpr bool is_zv_stage(const ShaperDesign& design) {
  const Tap* tap = design.taps;
  const int64_t sum = static_cast<int64_t>(tap[0].gain) + tap[1].gain + tap[2].gain;
  const bool positive = tap[0].gain > 0 && tap[1].gain >= 0 && tap[2].gain >= 0;
  return design.stage_count == 1 && design.tap_count == 3 && tap[0].delay_ticks == 0 &&
         tap[2].delay_ticks == tap[1].delay_ticks + 1 && sum == kUnityGain && positive;
}

constexpr bool within(double delta, double expected, int32_t gain) {
  const double miss = gain / static_cast<double>(kUnityGain) - expected;
  return miss <= delta && miss >= -delta;
}

// The reference's arm, section 3.
constexpr bool is_the_papers(const ShaperDesign& design) {
  return design.taps[1].delay_ticks == 45 && within(5e-6, 0.58594, design.taps[0].gain) &&
         within(5e-6, 0.11159, design.taps[1].gain) && within(5e-6, 0.30247, design.taps[2].gain);
}

static_assert(is_zv_stage(kDesigns[0]) && is_zv_stage(kDesigns[1]) && is_zv_stage(kDesigns[2]));
static_assert(is_zv_stage(kDesigns[3]) && is_zv_stage(kDesigns[4]));
static_assert(is_the_papers(kDesigns[0]));

// Impulses of either sign, whose rest does not fit 32 bits on the way.
constexpr ShaperDesign signed_stage() {
  const Impulse taps[] = {{0.0, 1.5}, {10.0, -1.25}, {20.0, 0.75}};
  ShaperDesign design{};
  append_stage(taps, 3, design);
  return design;
}
static_assert(signed_stage().taps[0].gain == kUnityGain / 2 * 3);

}  // namespace

TEST(designs_of_the_compiler_are_those_of_add_shaper_bit_for_bit) {
  for (uint32_t i = 0; i < kCount; ++i) {
    TEST_INFO("mode", i);
    ShaperDesign design{};
    TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, kModes[i], kTick, design));
    TEST_ASSERT_TRUE(is_zv_stage(design));
    for (uint32_t k = 0; k < 3; ++k) {
      TEST_ASSERT_EQUAL_UINT32(kDesigns[i].taps[k].delay_ticks, design.taps[k].delay_ticks);
      TEST_ASSERT_EQUAL_INT32(kDesigns[i].taps[k].gain, design.taps[k].gain);
    }
    if (i == 0) TEST_ASSERT_TRUE(is_the_papers(design));
  }
}
