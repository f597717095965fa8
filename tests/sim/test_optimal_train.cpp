// SPDX-License-Identifier: Apache-2.0
// The shortest positive train against the limits of reference 2, and against V evaluated here from its definition.
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <string>

#include "sim/optimal_train.hpp"
#include "sim/optimal_train_lp.hpp"
#include "sim/refusal.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::sim;

namespace {

// Park (1), term by term.
long double residual_of(const OptimalTrain& train, long double frequency_hz, long double damping, long double tick_s) {
  const long double w = 2.0L * 3.14159265358979323846264338327950288L * frequency_hz;
  const std::complex<long double> pole(damping * w, w * std::sqrt(1.0L - damping * damping));
  const long double end = static_cast<long double>(train.length_ticks) * tick_s;
  std::complex<long double> sum = 0.0L;
  for (const ImpulseTap& tap : train.taps) {
    sum += tap.gain * std::exp(pole * (static_cast<long double>(tap.delay_ticks) * tick_s) - pole.real() * end);
  }
  return std::abs(sum);
}

// On a grid all over the band, its inside too.
double worst_on_grid(const OptimalTrain& train, const ModeBand& band, double tick_s) {
  const int dampings = band.low_damping < band.high_damping ? 12 : 0;
  long double worst = 0.0L;
  for (int i = 0; i <= 1000; ++i) {
    for (int k = 0; k <= dampings; ++k) {
      const double frequency = band.low_hz + (band.high_hz - band.low_hz) * i / 1000.0;
      const double damping = band.low_damping + (band.high_damping - band.low_damping) * k / std::max(dampings, 1);
      worst = std::max(worst, residual_of(train, frequency, damping, tick_s));
    }
  }
  return static_cast<double>(worst);
}

void check_train(const OptimalTrain& train, const ModeBand& band, double tolerance, double tick_s) {
  long double sum = 0.0L;
  for (size_t i = 0; i < train.taps.size(); ++i) {
    TEST_ASSERT_TRUE(train.taps[i].gain >= 0.0L);
    if (i > 0) TEST_ASSERT_TRUE(train.taps[i].delay_ticks > train.taps[i - 1].delay_ticks);
    sum += train.taps[i].gain;
  }
  TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0, static_cast<double>(sum));
  TEST_ASSERT_EQUAL_UINT32(0, train.taps.front().delay_ticks);
  TEST_ASSERT_EQUAL_UINT32(train.length_ticks, train.taps.back().delay_ticks);
  TEST_ASSERT_AT_MOST_DOUBLE(tolerance, train.worst_residual);
  const double worst = worst_on_grid(train, band, tick_s);
  TEST_ASSERT_AT_MOST_DOUBLE(train.worst_residual * (1.0 + 1e-8), worst);
  TEST_ASSERT_AT_LEAST_DOUBLE(train.worst_residual * (1.0 - 1e-2), worst);
  TEST_ASSERT_AT_LEAST_DOUBLE(tolerance * (1.0 - 2e-6), train.shorter_leaves);
}

std::string refusal_of(const ModeBand& band, double tolerance, double tick_s) {
  try {
    static_cast<void>(shortest_positive_train(band, tolerance, tick_s));
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "accepted";
}

}  // namespace

TEST_HOST(known_limits_of_undamped_bands_are_met) {
  const struct {
    double low, high, periods;
  } cases[] = {{0.9, 1.1, 0.89}, {0.8, 1.2, 1.00}, {0.626, 1.393, 1.59}, {0.488, 1.707, 2.22}, {0.389, 2.168, 2.91}};
  for (const auto& each : cases) {
    const ModeBand band{each.low, each.high, 0.0, 0.0};
    const OptimalTrain train = shortest_positive_train(band, 0.05, 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, each.periods, train.length_ticks * 1e-3);
    check_train(train, band, 0.05, 1e-3);
    TEST_ASSERT_AT_MOST_INT64(24, train.taps.size());
  }
}

TEST_HOST(trains_keep_their_band_at_any_frequency_damping_and_tick) {
  const struct {
    ModeBand band;
    double tolerance, tick_s;
  } cases[] = {
      {{3.6, 4.4, 0.0, 0.0}, 0.05, 1e-3},      {{2.0, 6.8, 0.0, 0.0}, 0.05, 1e-3},
      {{0.4, 0.6, 0.0, 0.1}, 0.05, 1e-3},      {{0.5, 1.5, 0.02, 0.1}, 0.02, 1e-3},
      {{10.0, 12.0, 0.11, 0.11}, 0.05, 1e-3},  {{30.0, 45.0, 0.0, 0.3}, 0.1, 1e-3},
      {{120.0, 300.0, 0.0, 0.05}, 0.05, 1e-3}, {{100.0, 499.0, 0.0, 0.0}, 0.05, 1e-3},
      {{0.97, 1.03, 0.0, 0.1}, 0.001, 1e-4},   {{0.95, 1.05, 0.3, 0.3}, 0.2, 1e-3},
  };
  for (const auto& each : cases) {
    TEST_INFO("low_hz", each.band.low_hz);
    check_train(shortest_positive_train(each.band, each.tolerance, each.tick_s), each.band, each.tolerance,
                each.tick_s);
  }
}

// What the bisection leans on, and the bounds that it decides by.
TEST_HOST(the_least_residual_falls_with_the_length) {
  const ModeBand bands[] = {{20.0, 40.0, 0.0, 0.0}, {20.0, 40.0, 0.1, 0.1}, {20.0, 40.0, 0.0, 0.2}};
  for (const ModeBand& band : bands) {
    const std::vector<BandEdge> edges = edges_of(band, 1e-3);
    double before = 1.0;
    for (uint32_t length = 1; length <= 70; ++length) {
      LeastResidual programme(edges, length);
      programme.refine();
      TEST_ASSERT_AT_MOST_DOUBLE(programme.upper_bound(), programme.lower_bound());
      TEST_ASSERT_AT_MOST_DOUBLE(1e-4 * programme.upper_bound(), programme.upper_bound() - programme.lower_bound());
      TEST_ASSERT_AT_MOST_DOUBLE(before, programme.lower_bound());
      before = programme.upper_bound();
    }
  }
}

TEST_HOST(limits_rise_with_the_width_of_the_band) {
  const int percents[] = {3, 5, 7, 10, 12, 15, 20, 25, 30, 40, 50, 60};
  for (const double damping : {0.0, 0.1}) {
    double before = 0.0;
    for (const int percent : percents) {
      const auto start = std::chrono::steady_clock::now();
      const ModeBand band{1.0 - percent / 100.0, 1.0 + percent / 100.0, damping, damping};
      const double periods = shortest_positive_periods(band, 0.05, 1.0);
      const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
      char line[80];
      std::snprintf(line, sizeof line, "zeta %.1f  +-%2d %%  %.3f T  %4.0f ms", damping, percent, periods,
                    time.count());
      MESSAGE(line);
      TEST_ASSERT_AT_LEAST_DOUBLE(before, periods);
      before = periods;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.003, damping == 0.0 ? 2.764 : 2.394, before);  // as measured, both ways
  }
}

TEST_HOST(progress_rises_to_one) {
  double before = 0.0;
  int calls = 0;
  static_cast<void>(shortest_positive_train({9.0, 11.0, 0.0, 0.0}, 0.05, 1e-3, [&](double part_done) {
    TEST_ASSERT_AT_LEAST_DOUBLE(before, part_done);
    TEST_ASSERT_AT_MOST_DOUBLE(1.0, part_done);
    before = part_done;
    ++calls;
  }));
  TEST_ASSERT_AT_LEAST_INT64(3, calls);
}

TEST_HOST(bad_bands_are_refused_by_name) {
  const double nan = std::nan("");
  TEST_ASSERT_TRUE(refusal_of({0.0, 1.0, 0.0, 0.0}, 0.05, 1e-3) == "band from: 0: must be above zero");
  TEST_ASSERT_TRUE(refusal_of({nan, 1.0, 0.0, 0.0}, 0.05, 1e-3) == "band from: nan: must be above zero");
  TEST_ASSERT_TRUE(refusal_of({2.0, 2.0, 0.0, 0.0}, 0.05, 1e-3) == "band to: 2: must be above 2 Hz");
  TEST_ASSERT_TRUE(refusal_of({2.0, nan, 0.0, 0.0}, 0.05, 1e-3) == "band to: nan: must be above 2 Hz");
  TEST_ASSERT_TRUE(refusal_of({400.0, 500.0, 0.0, 0.0}, 0.05, 1e-3) == "band to: 500: must be below 500 Hz");
  TEST_ASSERT_TRUE(refusal_of({2.0, 41.0, 0.0, 0.0}, 0.05, 1e-3) == "band to: 41: must be at most 40 Hz");
  TEST_ASSERT_TRUE(refusal_of({2.0, 3.0, -0.1, 0.0}, 0.05, 1e-3) == "damping from: -0.1: must be in 0..0.3");
  TEST_ASSERT_TRUE(refusal_of({2.0, 3.0, 0.2, 0.1}, 0.05, 1e-3) == "damping to: 0.1: must be in 0.2..0.3");
  TEST_ASSERT_TRUE(refusal_of({2.0, 3.0, 0.0, 0.4}, 0.05, 1e-3) == "damping to: 0.4: must be in 0..0.3");
  TEST_ASSERT_TRUE(refusal_of({2.0, 3.0, 0.0, 0.0}, 0.3, 1e-3) == "tolerance: 0.3: must be in 0.001..0.2");
  TEST_ASSERT_TRUE(refusal_of({2.0, 3.0, 0.0, 0.0}, nan, 1e-3) == "tolerance: nan: must be in 0.001..0.2");
  TEST_ASSERT_TRUE(refusal_of({2.0, 3.0, 0.0, 0.0}, 0.05, 0.0) == "tick: 0: must be a finite number above zero");
  TEST_ASSERT_TRUE(refusal_of({1e-4, 1.1e-4, 0.0, 0.0}, 0.05, 1e-3).find("1048576 ticks") != std::string::npos);
}
