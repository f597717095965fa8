// SPDX-License-Identifier: Apache-2.0
// The transform against the sum that defines it, in long double with libm.
#include <cmath>
#include <vector>

#include "shaper/identify/fft.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

struct Bin {
  long double re = 0.0L;
  long double im = 0.0L;
};

std::vector<Bin> direct(const std::vector<double>& values) {
  const size_t size = values.size();
  std::vector<Bin> spectrum(size / 2 + 1);
  for (size_t k = 0; k <= size / 2; ++k) {
    for (size_t n = 0; n < size; ++n) {
      const long double angle = -2.0L * std::acos(-1.0L) * static_cast<long double>(k * n % size) / size;
      spectrum[k].re += static_cast<long double>(values[n]) * std::cos(angle);
      spectrum[k].im += static_cast<long double>(values[n]) * std::sin(angle);
    }
  }
  return spectrum;
}

// The largest error over the root of the sum of squares.
double worst_error(std::vector<double> values) {
  const size_t size = values.size();
  const std::vector<Bin> expected = direct(values);
  long double energy = 0.0L;
  for (const double value : values) energy += static_cast<long double>(value) * value;
  if (!real_fft(values.data(), size)) return HUGE_VAL;
  long double worst = std::fabs(values[0] - expected[0].re);
  worst = std::fmax(worst, std::fabs(values[1] - expected[size / 2].re));
  for (size_t k = 1; k < size / 2; ++k) {
    worst = std::fmax(worst, std::hypot(values[2 * k] - expected[k].re, values[2 * k + 1] - expected[k].im));
  }
  return static_cast<double>(worst / std::sqrt(energy));
}

}  // namespace

TEST_HOST(the_transform_is_the_sum_that_defines_it) {
  Random random(17);
  for (size_t size = kLeastFft; size <= kLargestFft; size *= 2) {
    std::vector<double> values(size);
    for (double& value : values) value = random.between(-1.0, 1.0);
    TEST_INFO(size, size);
    TEST_ASSERT_AT_MOST_DOUBLE(4e-16 * std::log2(static_cast<double>(size)), worst_error(values));
  }
}

TEST_HOST(hanns_window_is_the_one_of_the_books) {
  std::vector<double> values(48, 1.0);
  apply_hann(values.data(), values.size());
  for (size_t n = 0; n < values.size(); ++n) {
    const double expected = 0.5 - 0.5 * std::cos(2.0 * std::acos(-1.0) * static_cast<double>(n) / 48.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, expected, values[n]);
  }
}
