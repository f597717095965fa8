// SPDX-License-Identifier: Apache-2.0
// What must never be called a mode.
#include <algorithm>
#include <cmath>

#include "shaper/identify/identify.hpp"
#include "tests/shaper/identify/ringing.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

IdentifyMemory<kLargestFft> memory;

Identification identified(const std::vector<float>& samples) {
  IdentifyConfig config;
  config.rate_hz = 1000.0;
  Identification found{};
  TEST_ASSERT_OK(identify(record_of(samples), config, IdentifyScratch(memory), found));
  return found;
}

std::vector<float> white(Random& random, size_t count) {
  std::vector<float> samples(count);
  for (float& sample : samples) sample = static_cast<float>(normal(random));
  return samples;
}

// White noise through two poles of this radius and angle, the settling left out.
std::vector<float> coloured(Random& random, size_t count, double radius, double angle) {
  const auto settling = static_cast<size_t>(std::min(5000.0, 10.0 / (1.0 - radius)));
  std::vector<float> samples(count);
  double before = 0.0, here = 0.0;
  for (size_t n = 0; n < count + settling; ++n) {
    const double next = normal(random) + 2.0 * radius * std::cos(angle) * here - radius * radius * before;
    before = here;
    here = next;
    if (n >= settling) samples[n - settling] = static_cast<float>(here);
  }
  return samples;
}

std::vector<float> any_noise(Random& random, int kind) {
  const size_t count = static_cast<size_t>(random.integer(300, 2000));
  switch (kind % 5) {
    case 0: return white(random, count);
    case 1: return coloured(random, count, random.between(0.5, 0.99), 0.0);                       // low frequencies
    case 2: return coloured(random, count, random.between(0.5, 0.9), M_PI);                       // high frequencies
    case 3: return coloured(random, count, random.between(0.7, 0.98), random.between(0.1, 2.0));  // a broad hump
    default: {
      std::vector<float> samples = white(random, count);  // a random walk
      for (size_t n = 1; n < count; ++n) samples[n] += samples[n - 1];
      return samples;
    }
  }
}

struct Sinusoid {
  double frequency_hz;
  double damping_ratio;
  double amplitude = 1.0;
};

std::vector<float> sinusoid(Random& random, const Sinusoid& of, double duration_s, double noise) {
  Ringing ringing;
  ringing.duration_s = duration_s;
  ringing.noise = noise;
  ringing.modes = {{of.frequency_hz, of.damping_ratio, of.amplitude, random.between(-M_PI, M_PI)}};
  return noisy(ringing, clean(ringing), random);
}

}  // namespace

// At most one in a hundred; and no record comes back without a reason.
TEST_HOST(a_thousand_records_of_noise_hold_no_mode) {
  Random random(2026);
  int found = 0;
  for (int i = 0; i < 1000; ++i) {
    const Identification answer = identified(any_noise(random, i));
    found += answer.finding == Finding::kFound ? 1 : 0;
    if (answer.finding != Finding::kFound) TEST_ASSERT_EQUAL_UINT64(0, answer.mode_count);
  }
  TEST_INFO(found, found);
  TEST_ASSERT_AT_MOST_INT64(10, found);
}

TEST_HOST(hum_is_not_ringing) {
  Random random(50);
  for (int i = 0; i < 100; ++i) {
    const double hz = i % 2 == 0 ? 50.0 : 60.0;
    const std::vector<float> samples =
        sinusoid(random, {hz, 0.0}, random.between(0.5, 4.0), std::exp(random.between(-6.0, -0.5)));
    const Identification answer = identified(samples);
    TEST_INFO(record, i);
    TEST_ASSERT_FALSE(answer.finding == Finding::kFound);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, hz, answer.hum_hz);
  }
}

// A hum beside the ringing is told from it.
TEST_HOST(ringing_is_found_beside_hum) {
  Random random(51);
  for (int i = 0; i < 50; ++i) {
    const double hz = random.between(5.0, 30.0);
    std::vector<float> samples = sinusoid(random, {hz, 0.03}, 2.0, 0.02);
    const std::vector<float> hum = sinusoid(random, {50.0, 0.0, 0.5}, 2.0, 0.0);
    for (size_t n = 0; n < samples.size(); ++n) samples[n] += hum[n];
    const Identification answer = identified(samples);
    TEST_INFO(record, i);
    TEST_ASSERT_EQUAL_ENUM(Finding::kFound, answer.finding);
    TEST_ASSERT_EQUAL_UINT64(1, answer.mode_count);
    TEST_ASSERT_DOUBLE_RELATIVE(0.01, hz, answer.mode[0].frequency_hz);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 50.0, answer.hum_hz);
  }
}

TEST_HOST(constants_and_ramps_hold_no_mode) {
  Random random(52);
  for (int i = 0; i < 100; ++i) {
    const double offset = random.between(-1e4, 1e4), slope = i % 2 == 0 ? 0.0 : random.between(-10.0, 10.0);
    const double noise = i % 4 < 2 ? 0.0 : std::exp(random.between(-8.0, 2.0));
    std::vector<float> samples(static_cast<size_t>(random.integer(100, 4000)));
    for (size_t n = 0; n < samples.size(); ++n) {
      samples[n] = static_cast<float>(offset + slope * static_cast<double>(n) + noise * normal(random));
    }
    TEST_INFO(record, i);
    TEST_ASSERT_FALSE(identified(samples).finding == Finding::kFound);
  }
}

TEST_HOST(a_clipped_record_is_saturated) {
  Random random(53);
  for (int i = 0; i < 100; ++i) {
    const double hz = random.between(2.0, 60.0), zeta = std::exp(random.between(-6.0, -2.5));
    std::vector<float> samples = sinusoid(random, {hz, zeta}, random.between(0.5, 3.0), i % 2 == 0 ? 0.0 : 0.01);
    const float extreme = *std::max_element(samples.begin(), samples.end());
    const float limit = static_cast<float>(random.between(0.3, 0.8)) * extreme;
    for (float& sample : samples) sample = std::clamp(sample, -limit, limit);
    TEST_INFO(record, i);
    TEST_INFO(frequency, hz);
    TEST_ASSERT_EQUAL_ENUM(Finding::kSaturated, identified(samples).finding);
  }
}

// Where noise came on top of what the sensor cut off no two samples are the same: it is seen when it is deep.
TEST_HOST(deep_clipping_below_noise_is_mostly_seen) {
  Random random(56);
  int saturated = 0;
  for (int i = 0; i < 100; ++i) {
    const double hz = random.between(5.0, 60.0), zeta = std::exp(random.between(-6.0, -2.5));
    std::vector<float> samples = sinusoid(random, {hz, zeta}, 2.0, 0.0);
    const float limit =
        static_cast<float>(random.between(0.3, 0.5)) * *std::max_element(samples.begin(), samples.end());
    for (float& sample : samples)
      sample = std::clamp(sample, -limit, limit) + static_cast<float>(0.005 * normal(random));
    saturated += identified(samples).finding == Finding::kSaturated ? 1 : 0;
  }
  TEST_INFO(saturated, saturated);
  TEST_ASSERT_AT_LEAST_INT64(85, saturated);
}

TEST_HOST(fewer_than_three_periods_are_too_few) {
  Random random(54);
  for (int i = 0; i < 100; ++i) {
    const double duration = random.between(0.5, 4.0), periods = random.between(0.3, 2.8);
    const std::vector<float> samples = sinusoid(random, {periods / duration, 0.02}, duration, 0.01);
    TEST_INFO(periods, periods);
    TEST_ASSERT_FALSE(identified(samples).finding == Finding::kFound);
  }
}

// An envelope that falls in a straight line and stands: Coulomb friction.
TEST_HOST(friction_is_not_viscous) {
  Random random(55);
  for (int i = 0; i < 50; ++i) {
    const double hz = random.between(3.0, 30.0), end_s = random.between(0.6, 0.95) * 2.0;
    std::vector<float> samples(2000);
    for (size_t n = 0; n < samples.size(); ++n) {
      const double t = static_cast<double>(n) / 1000.0;
      samples[n] =
          static_cast<float>(std::max(0.0, 1.0 - t / end_s) * std::cos(2.0 * M_PI * hz * t) + 0.01 * normal(random));
    }
    const Identification answer = identified(samples);
    TEST_INFO(frequency, hz);
    TEST_ASSERT_EQUAL_ENUM(Finding::kFound, answer.finding);
    TEST_ASSERT_FALSE(answer.mode[0].viscous);
    TEST_ASSERT_AT_MOST_DOUBLE(0.55, answer.confidence);
    TEST_ASSERT_AT_LEAST_DOUBLE(answer.mode[0].damping_early, answer.mode[0].damping_late);
  }
}

// Least squares in coloured noise errs by the noise where the mode is, and says so: noise of low frequencies.
TEST_HOST(deviations_are_true_in_coloured_noise) {
  Random random(57);
  int records = 0, inside_frequency = 0, inside_damping = 0;
  for (int i = 0; i < 300; ++i) {
    const double hz = random.between(5.0, 40.0), zeta = i % 2 == 0 ? 0.005 : 0.05;
    std::vector<float> samples = sinusoid(random, {hz, zeta}, 2.0, 0.0);
    const std::vector<float> noise = coloured(random, samples.size(), 0.7, 0.3);
    for (size_t n = 0; n < samples.size(); ++n) samples[n] += 0.03F * noise[n];
    const Identification answer = identified(samples);
    if (answer.finding != Finding::kFound) continue;
    ++records;
    inside_frequency += std::fabs(answer.mode[0].frequency_hz - hz) < answer.mode[0].frequency_std_hz ? 1 : 0;
    inside_damping += std::fabs(answer.mode[0].damping_ratio - zeta) < answer.mode[0].damping_std ? 1 : 0;
  }
  TEST_INFO(records, records);
  TEST_ASSERT_AT_LEAST_INT64(285, records);
  // Four standard deviations of the count about 68 %.
  const double spread = 4.0 * std::sqrt(0.217 * records);
  TEST_ASSERT_DOUBLE_WITHIN(spread, 0.683 * records, inside_frequency);
  TEST_ASSERT_DOUBLE_WITHIN(spread, 0.683 * records, inside_damping);
}
