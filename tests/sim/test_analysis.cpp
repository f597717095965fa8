// SPDX-License-Identifier: Apache-2.0
// The analysis of shapers against the figures of the papers.
#include <cmath>
#include <complex>

#include "sim/analysis.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::sim;

namespace {

double as_double(long double value) { return static_cast<double>(value); }

SpecifiedShaper spec(ShaperKind kind, double frequency_hz, double damping_ratio) {
  return shaper_spec(kind, {frequency_hz, damping_ratio});
}

}  // namespace

TEST_HOST(continuous_impulses_are_those_of_li_2017) {
  const std::vector<ExactImpulse> zv = continuous_impulses(spec(ShaperKind::kZv, 11.0, 0.11));
  TEST_ASSERT_EQUAL_UINT32(2, zv.size());
  TEST_ASSERT_DOUBLE_WITHIN(5e-5, 0.5861, as_double(zv[0].amplitude));
  TEST_ASSERT_DOUBLE_WITHIN(5e-5, 0.4139, as_double(zv[1].amplitude));
  TEST_ASSERT_DOUBLE_WITHIN(5e-5, 0.0457, as_double(zv[1].time_s));
}

TEST_HOST(continuous_impulses_leave_nothing_of_their_own_mode) {
  testing::Random random(21);
  for (int i = 0; i < 200; ++i) {
    const double frequency = random.between(0.5, 300.0);
    const double damping = random.between(0.0, 0.3);
    for (const ShaperKind kind : {ShaperKind::kZv, ShaperKind::kZvd}) {
      const std::vector<ExactImpulse> impulses = continuous_impulses(spec(kind, frequency, damping));
      long double sum = 0.0L;
      for (const ExactImpulse& impulse : impulses) sum += impulse.amplitude;
      TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0, as_double(sum));
      TEST_ASSERT_AT_MOST_DOUBLE(1e-15, as_double(residual(impulses, {frequency, damping})));
    }
  }
}

// Reference 2: insensitivities at 5 %, undamped.
TEST_HOST(bands_are_as_wide_as_the_reference_says) {
  const struct {
    ShaperKind kind;
    double width;
  } cases[] = {{ShaperKind::kZv, 0.0637}, {ShaperKind::kZvd, 0.2871}};
  for (const auto& each : cases) {
    // Slow against the tick, so that the grid is no part of it.
    const Band band = tolerated_band(design_for({spec(each.kind, 1.0, 0.0)}, 1e-3), {1.0, 0.0}, 0.05, 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, each.width, band.high_ratio - band.low_ratio);
    TEST_ASSERT_TRUE(band.low_ratio < 1.0 && band.high_ratio > 1.0);
  }
}

TEST_HOST(the_residual_is_the_tolerance_at_the_ends_of_the_band_and_less_between) {
  const double tick_s = 1e-3;
  const Mode mode{37.3, 0.08};
  const ShaperDesign design = design_for({spec(ShaperKind::kZvd, 37.3, 0.08)}, tick_s);
  const Band band = tolerated_band(design, mode, 0.05, tick_s);
  const auto left_at = [&](double ratio) {
    return as_double(residual_on_grid(design, {ratio * mode.frequency_hz, mode.damping_ratio}, tick_s));
  };
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.05, left_at(band.low_ratio));
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.05, left_at(band.high_ratio));
  for (int i = 0; i <= 100; ++i) {
    TEST_ASSERT_AT_MOST_DOUBLE(0.05 + 1e-9, left_at(band.low_ratio + (band.high_ratio - band.low_ratio) * i / 100.0));
  }
}

TEST_HOST(a_mode_that_is_not_tolerated_itself_has_no_band) {
  const Band band = tolerated_band(ShaperDesign{}, {11.0, 0.1}, 0.05, 1e-3);
  TEST_ASSERT_TRUE(band.low_ratio == 1.0 && band.high_ratio == 1.0);
}

TEST_HOST(the_residual_on_the_grid_is_the_transfer_at_the_sampled_pole) {
  const double tick_s = 1e-3;
  const ShaperDesign design = design_for(parse_shapers("zv:11:0.11+zvd:40:0.05"), tick_s);
  const Mode plant{13.0, 0.07};
  const long double w = 2.0L * 3.14159265358979323846264338L * 13.0L;
  const std::complex<long double> s(-0.07L * w, w * std::sqrt(1.0L - 0.07L * 0.07L));
  std::complex<long double> transfer = 0.0L;
  for (const ImpulseTap& tap : multiplied_out(design, kMostTaps)) {
    transfer += tap.gain * std::exp(-s * (static_cast<long double>(tap.delay_ticks) * 1e-3L));
  }
  const long double expected = std::abs(transfer) * std::exp(-0.07L * w * 1e-3L * design.length_ticks());
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, as_double(expected), as_double(residual_on_grid(design, plant, tick_s)));
}

TEST_HOST(stages_multiplied_out_sum_to_one_and_end_at_the_length) {
  const ShaperDesign design = design_for(parse_shapers("zv:11:0.11+zvd:40:0.05"), 1e-3);
  const std::vector<ImpulseTap> taps = multiplied_out(design, kMostTaps);
  long double sum = 0.0L;
  for (const ImpulseTap& tap : taps) sum += tap.gain;
  TEST_ASSERT_DOUBLE_WITHIN(1e-18, 1.0, as_double(sum));
  TEST_ASSERT_EQUAL_UINT32(design.length_ticks(), taps.back().delay_ticks);
  TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0, as_double(peak_gain(design)));
  TEST_ASSERT_TRUE(multiplied_out(design, 5).empty());
}
