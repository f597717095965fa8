// SPDX-License-Identifier: Apache-2.0
// What is recommended against the shortest positive train that any method can find, and against V evaluated here.
#include "shaper/shaping/recommend.hpp"

#include <cmath>
#include <complex>
#include <cstdio>

#include "sim/optimal_train.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;
constexpr double kTolerance = 0.05;

ShaperDesign design_of(const Candidate& candidate) {
  ShaperDesign design{};
  for (uint32_t i = 0; i < candidate.spec_count; ++i) {
    TEST_ASSERT_OK(add_shaper(candidate.specs[i], kTick, design));
  }
  return design;
}

// Park (1) of each stage, term by term, multiplied.
double residual_of(const ShaperDesign& design, double frequency_hz, double damping) {
  const long double w = 2.0L * 3.14159265358979323846264338327950288L * frequency_hz;
  const std::complex<long double> pole(damping * w, w * std::sqrt(1.0L - static_cast<long double>(damping) * damping));
  long double product = 1.0L;
  for (uint32_t s = 0; s < design.stage_count; ++s) {
    const Stage& stage = design.stages[s];
    const long double end = design.taps[stage.first_tap + stage.tap_count - 1].delay_ticks * 0.001L;
    std::complex<long double> sum = 0.0L;
    for (uint32_t k = stage.first_tap; k < stage.first_tap + stage.tap_count; ++k) {
      const Tap& tap = design.taps[k];
      sum += static_cast<long double>(tap.gain) / kUnityGain *
             std::exp(pole * (tap.delay_ticks * 0.001L) - pole.real() * end);
    }
    product *= std::abs(sum);
  }
  return static_cast<double>(product);
}

double worst_inside(const ShaperDesign& design, const ModeBand& band) {
  double worst = 0.0;
  const int dampings = band.high_damping > band.low_damping ? 10 : 0;
  for (int i = 0; i <= 800; ++i) {
    for (int k = 0; k <= dampings; ++k) {
      const double frequency = band.low_hz + (band.high_hz - band.low_hz) * i / 800.0;
      const double damping = band.low_damping + (band.high_damping - band.low_damping) * k / std::max(dampings, 1);
      worst = std::max(worst, residual_of(design, frequency, damping));
    }
  }
  return worst;
}

}  // namespace

TEST_HOST(recommendations_are_at_most_15_percent_longer_than_any_positive_train_can_be) {
  // Half widths of bands about 2 Hz, slow against the tick. 3.3, 14.6, 20.6, 24.5, 31.8 and 36.5 % are just wider than
  // the own bands of ZV, ZVD, EI, ZVDD, ZVDDD and EI2.
  constexpr double kWidths[] = {0.03,  0.033, 0.05, 0.07, 0.10,  0.12,  0.146, 0.15, 0.20,
                                0.206, 0.245, 0.25, 0.30, 0.318, 0.365, 0.40,  0.50, 0.60};
  std::printf("band     zeta   limit [periods]   recommended   ratio   worst [%%]\n");
  double worst_ratio = 0.0;
  int within_5_percent = 0;
  int bands = 0;
  for (const double damping : {0.0, 0.1}) {
    for (const double width : kWidths) {
      const ModeBand band{2.0 * (1.0 - width), 2.0 * (1.0 + width), damping, damping};
      Candidate best{};
      TEST_ASSERT_OK(recommend(band, kTolerance, kTick, best));
      const double periods = best.length_ticks * kTick * 2.0;
      const double limit = sim::shortest_positive_periods(band, kTolerance, 2.0);
      const double worst = worst_inside(design_of(best), band);
      std::printf("+-%4.1f %%  %.1f   %15.4f   %11.4f   %.4f   %.3f\n", 100.0 * width, damping, limit, periods,
                  periods / limit, 100.0 * worst);
      TEST_INFO("width", width);
      TEST_INFO("damping", damping);
      TEST_ASSERT_AT_MOST_DOUBLE(kTolerance * (1.0 + 1e-9), worst);
      TEST_ASSERT_AT_MOST_DOUBLE(1.15, periods / limit);
      TEST_ASSERT_AT_LEAST_DOUBLE(0.998, periods / limit);  // shorter than the limit: one of the two is wrong
      worst_ratio = std::max(worst_ratio, periods / limit);
      within_5_percent += periods / limit <= 1.05 ? 1 : 0;
      ++bands;
    }
  }
  std::printf("%d bands, %d within 5 %%, the worst %.4f\n", bands, within_5_percent, worst_ratio);
}

TEST_HOST(recommendations_keep_random_bands_on_the_ticks) {
  const uint64_t seed = 20;
  TEST_INFO("seed", seed);
  testing::Random random(seed);
  int found = 0;
  for (int i = 0; i < 60; ++i) {
    TEST_INFO("case", i);
    const double low = 0.5 * std::pow(300.0, random.unit());
    const double damping = random.between(0.0, 0.2);
    const ModeBand band{low, std::min(low * random.between(1.02, 3.0), 450.0), damping,
                        damping + (i % 2 == 0 ? 0.0 : random.between(0.0, 0.1))};
    const double tolerance = 0.002 * std::pow(100.0, random.unit());
    Candidate best{};
    if (!recommend(band, tolerance, kTick, best).ok()) continue;
    ++found;
    TEST_ASSERT_AT_MOST_DOUBLE(tolerance * (1.0 + 1e-9), worst_inside(design_of(best), band));
    TEST_ASSERT_EQUAL_UINT32(best.length_ticks, design_of(best).length_ticks());
  }
  std::printf("%d of 60 random bands kept\n", found);
  TEST_ASSERT_AT_LEAST_INT64(40, found);
}

TEST_HOST(bad_questions_are_refused_by_name_and_leave_the_answer_alone) {
  Candidate answer{};
  answer.length_ticks = 77;
  const double nan = std::nan("");
  TEST_ASSERT_REFUSED(kNotFinite, kFrequency, recommend({nan, 2, 0, 0}, 0.05, kTick, answer));
  TEST_ASSERT_REFUSED(kNotPositive, kFrequency, recommend({0, 2, 0, 0}, 0.05, kTick, answer));
  TEST_ASSERT_REFUSED(kBelowMinimum, kFrequency, recommend({2, 2, 0, 0}, 0.05, kTick, answer));
  TEST_ASSERT_REFUSED(kAboveMaximum, kFrequency, recommend({2, 500, 0, 0}, 0.05, kTick, answer));
  TEST_ASSERT_REFUSED(kBelowMinimum, kDampingRatio, recommend({2, 3, -0.1, 0}, 0.05, kTick, answer));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDampingRatio, recommend({2, 3, 0, 0.31}, 0.05, kTick, answer));
  TEST_ASSERT_REFUSED(kNotPositive, kTick, recommend({2, 3, 0, 0}, 0.05, 0.0, answer));
  TEST_ASSERT_REFUSED(kNotFinite, kTolerance, recommend({2, 3, 0, 0}, nan, kTick, answer));
  TEST_ASSERT_REFUSED(kBelowMinimum, kTolerance, recommend({2, 3, 0, 0}, 1e-5, kTick, answer));
  TEST_ASSERT_REFUSED(kAboveMaximum, kTolerance, recommend({2, 3, 0, 0}, 0.5, kTick, answer));
  TEST_ASSERT_REFUSED(kNotAvailable, kTolerance, recommend({2, 40, 0, 0}, 0.01, kTick, answer));
  TEST_ASSERT_EQUAL_UINT32(77, answer.length_ticks);
}
