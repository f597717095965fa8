// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/design.hpp"

#include "tests/support/test.hpp"

#ifndef STILLPOINT_CHIP_TESTS
#include <cmath>
#include <complex>
#endif

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

constexpr double kTick = 1e-3;

ShaperDesign designed(ShaperKind kind, double frequency_hz, double damping_ratio) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(kind, Mode{frequency_hz, damping_ratio}, kTick, design));
  return design;
}

}  // namespace

TEST(the_papers_arm_gets_the_checked_taps) {
  const ShaperDesign design = designed(ShaperKind::kZv, 11.0, 0.11);
  TEST_ASSERT_EQUAL_UINT32(1, design.stage_count);
  TEST_ASSERT_EQUAL_UINT32(3, design.tap_count);
  const uint32_t delays[] = {0, 45, 46};
  const double gains[] = {0.58594, 0.11159, 0.30247};
  for (unsigned i = 0; i < 3; ++i) {
    TEST_ASSERT_EQUAL_UINT32(delays[i], design.taps[i].delay_ticks);
    TEST_ASSERT_DOUBLE_WITHIN(5e-6, gains[i], design.taps[i].gain / static_cast<double>(kUnityGain));
  }
  TEST_ASSERT_EQUAL_UINT32(46, design.length_ticks());
}

TEST(zvd_is_the_zv_stage_twice) {
  const ShaperDesign zv = designed(ShaperKind::kZv, 37.3, 0.05);
  const ShaperDesign zvd = designed(ShaperKind::kZvd, 37.3, 0.05);
  TEST_ASSERT_EQUAL_UINT32(2, zvd.stage_count);
  for (unsigned i = 0; i < 3; ++i) {
    TEST_ASSERT_EQUAL_INT32(zv.taps[i].gain, zvd.taps[i].gain);
    TEST_ASSERT_EQUAL_INT32(zv.taps[i].gain, zvd.taps[i + 3].gain);
  }
  TEST_ASSERT_EQUAL_UINT32(2 * zv.length_ticks(), zvd.length_ticks());
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 2 * zv.delay_ticks(), zvd.delay_ticks());
}

TEST(gains_of_every_stage_sum_to_one_as_integers_and_are_positive) {
  const uint64_t seed = 9;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 200; ++i) {
    const ShaperDesign design = designed(ShaperKind::kZv, random.between(0.5, 300.0), random.between(0.0, 0.3));
    int64_t sum = 0;
    for (uint32_t k = 0; k < design.tap_count; ++k) {
      sum += design.taps[k].gain;
      TEST_ASSERT_AT_LEAST_INT64(0, design.taps[k].gain);
    }
    TEST_ASSERT_EQUAL_INT64(kUnityGain, sum);
  }
}

TEST(modes_add_stages_until_there_is_no_room) {
  ShaperDesign design{};
  for (unsigned i = 0; i < ShaperDesign::kMaxStages; ++i) {
    TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{10.0 + i, 0.0}, kTick, design));
  }
  const Status status = add_shaper(ShaperKind::kZv, Mode{10.0, 0.0}, kTick, design);
  TEST_ASSERT_REFUSED(kTooManyStages, kStages, status);
  TEST_ASSERT_DOUBLE_WITHIN(0, ShaperDesign::kMaxStages, status.accepted);
  TEST_ASSERT_EQUAL_UINT32(ShaperDesign::kMaxStages, design.stage_count);
}

TEST(no_shaper_adds_nothing) { TEST_ASSERT_EQUAL_UINT32(0, designed(ShaperKind::kNone, 10.0, 0.0).stage_count); }

TEST(bad_modes_are_refused_by_name_with_what_would_be_accepted) {
  ShaperDesign design{};
  const auto add = [&design](double frequency_hz, double damping_ratio, double tick_s = kTick) {
    return add_shaper(ShaperKind::kZv, Mode{frequency_hz, damping_ratio}, tick_s, design);
  };
  const double nan = __builtin_nan("");
  TEST_ASSERT_REFUSED(kNotFinite, kFrequency, add(nan, 0));
  TEST_ASSERT_REFUSED(kNotPositive, kFrequency, add(0, 0));
  TEST_ASSERT_REFUSED(kNotFinite, kDampingRatio, add(10, nan));
  TEST_ASSERT_REFUSED(kBelowMinimum, kDampingRatio, add(10, -0.01));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDampingRatio, add(10, 1.0));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDampingRatio, add(10, 0.31));
  TEST_ASSERT_REFUSED(kNotPositive, kTick, add(10, 0, 0.0));
  const Status high = add(491, 0);
  TEST_ASSERT_REFUSED(kAboveMaximum, kFrequency, high);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 490.0, high.accepted);
  TEST_ASSERT_OK(add(high.accepted, 0));
  design = ShaperDesign{};
  const Status low = add(1e-5, 0);
  TEST_ASSERT_REFUSED(kBelowMinimum, kFrequency, low);
  TEST_ASSERT_OK(add(low.accepted, 0));
}

TEST(the_lowest_frequency_for_a_line_is_the_one_that_just_fits) {
  const uint32_t lines[] = {3, 4, 64, 1000, 2048};
  for (unsigned i = 0; i < 5; ++i) {
    for (double damping = 0.0; damping <= 0.3; damping += 0.1) {
      const double lowest =
          lowest_frequency_hz(ShaperSpec{ShaperKind::kZv, {1.0, damping}, 0.0, 0.0, nullptr}, kTick, lines[i]);
      if (lowest > 490) continue;
      TEST_ASSERT_AT_MOST_INT64(lines[i], designed(ShaperKind::kZv, lowest, damping).line_length());
      TEST_ASSERT_AT_LEAST_INT64(lines[i] + 1, designed(ShaperKind::kZv, lowest * 0.9999, damping).line_length());
    }
  }
}

#ifndef STILLPOINT_CHIP_TESTS

namespace {

// |A(p)| of the whole cascade with its gains as run: what is left of the plain residual vibration, in 80-bit floating
// point from the definition.
double residual_at_pole(const ShaperDesign& design, const Mode& mode) {
  using Complex = std::complex<long double>;
  const long double w = 2 * 3.14159265358979323846264338327950288L * mode.frequency_hz;
  const long double zeta = mode.damping_ratio;
  const Complex log_pole = Complex(-zeta * w, w * std::sqrt(1 - zeta * zeta)) * 0.001L;
  Complex product = 1;
  for (uint32_t s = 0; s < design.stage_count; ++s) {
    Complex sum = 0;
    for (uint32_t k = 0; k < design.stages[s].tap_count; ++k) {
      const Tap& tap = design.taps[design.stages[s].first_tap + k];
      sum += static_cast<long double>(tap.gain) / kUnityGain *
             std::exp(-log_pole * static_cast<long double>(tap.delay_ticks));
    }
    product *= sum;
  }
  return static_cast<double>(std::abs(product));
}

}  // namespace

TEST_HOST(quantised_stages_leave_a_millionth_at_most_over_the_whole_range) {
  double worst = 0.0;
  for (int i = 0; i <= 60; ++i) {
    for (int k = 0; k <= 12; ++k) {
      const Mode mode{0.5 * std::pow(600.0, i / 60.0), 0.3 * k / 12.0};
      for (const ShaperKind kind : {ShaperKind::kZv, ShaperKind::kZvd}) {
        worst = std::max(worst, residual_at_pole(designed(kind, mode.frequency_hz, mode.damping_ratio), mode));
      }
    }
  }
  MESSAGE("worst |A(p)| over 793 modes, ZV and ZVD: ", worst);
  TEST_ASSERT_AT_MOST_DOUBLE(4e-9, worst);    // the bound stated at add_shaper; asked for is 1e-6
  TEST_ASSERT_AT_LEAST_DOUBLE(1e-11, worst);  // better than the rounding of the gains can be means the test is blind
}

TEST_HOST(every_mode_of_a_two_mode_shaper_is_left_still) {
  ShaperDesign design{};
  const Mode first{11.0, 0.11};
  const Mode second{37.3, 0.02};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, first, kTick, design));
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZvd, second, kTick, design));
  TEST_ASSERT_AT_MOST_DOUBLE(1e-8, residual_at_pole(design, first));
  TEST_ASSERT_AT_MOST_DOUBLE(1e-15, residual_at_pole(design, second));
}

#endif
