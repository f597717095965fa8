// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/fft.hpp"

#include "shaper/base/math.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

TEST(only_powers_of_two_are_transformed) {
  double values[4] = {1.0, 2.0, 3.0, 4.0};
  constexpr size_t kRefused[] = {0, 1, 2, 3, 6, 8192};
  for (const size_t size : kRefused) TEST_ASSERT_FALSE(real_fft(values, size));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 3.0, values[2]);
  TEST_ASSERT_EQUAL_UINT64(4096, fft_size_for(4096));
  TEST_ASSERT_EQUAL_UINT64(2048, fft_size_for(1025));
  TEST_ASSERT_EQUAL_UINT64(0, fft_size_for(4097));
}

TEST(the_spectrum_of_four_values_is_the_one_by_hand) {
  double values[4] = {1.0, 2.0, 4.0, 8.0};
  TEST_ASSERT_TRUE(real_fft(values, 4));
  constexpr double kByHand[] = {15.0, -5.0, -3.0, 6.0};
  for (int i = 0; i < 4; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-15, kByHand[i], values[i]);
}

// Parseval: the powers, both halves of the circle, hold size times the energy of the record.
TEST(power_is_kept) {
  constexpr size_t kSize = 256;
  static double values[kSize];
  Random random(3);
  double energy = 0.0;
  for (double& value : values) {
    value = random.between(-1.0, 1.0);
    energy += value * value;
  }
  TEST_ASSERT_TRUE(real_fft(values, kSize));
  to_power(values, kSize);
  double power = values[0] + values[kSize / 2];
  for (size_t k = 1; k < kSize / 2; ++k) power += 2.0 * values[k];
  TEST_ASSERT_DOUBLE_RELATIVE(1e-13, kSize * energy, power);
}

// A sinusoid anywhere between two bins is found by its peak: 0.18 bins without a window, 0.02 with Hann's.
TEST(an_interpolated_peak_stands_where_the_sinusoid_does) {
  constexpr size_t kSize = 512;
  static double values[kSize];
  for (int window = 0; window < 2; ++window) {
    for (int i = 0; i <= 40; ++i) {
      const double bin = 60.0 + i / 40.0;
      for (size_t n = 0; n < kSize; ++n)
        values[n] = math::cos(6.283185307179586 * bin * static_cast<double>(n) / kSize);
      if (window == 1) apply_hann(values, kSize);
      TEST_ASSERT_TRUE(real_fft(values, kSize));
      to_power(values, kSize);
      size_t top = 1;
      for (size_t k = 1; k < kSize / 2; ++k) top = values[k] > values[top] ? k : top;
      TEST_INFO(bin, bin);
      TEST_ASSERT_DOUBLE_WITHIN(window == 0 ? 0.18 : 0.02, bin, interpolated_peak(values, kSize, top));
    }
  }
}
