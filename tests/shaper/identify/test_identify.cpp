// SPDX-License-Identifier: Apache-2.0
// What identify() answers, on the chip too.
#include "shaper/identify/identify.hpp"

#include "shaper/identify/decrement.hpp"
#include "shaper/identify/quiet_start.hpp"
#include "shaper/identify/saturation.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

constexpr size_t kSamples = 512;
constexpr double kRateHz = 250.0;
constexpr double kTwoPi = 6.283185307179586;

float samples[kSamples];
IdentifyMemory<kSamples> memory;

struct Truth {
  double frequency_hz;
  double damping_ratio;
  double amplitude;
};

// Sum of twelve uniform values: normal enough, and the same on the chip.
double normal(Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.unit();
  return sum;
}

void ring(const Truth& truth, double noise, size_t count) {
  Random random(5);
  const double w = kTwoPi * truth.frequency_hz;
  for (size_t n = 0; n < count; ++n) {
    const double t = static_cast<double>(n) / kRateHz;
    samples[n] = static_cast<float>(7.0 +
                                    truth.amplitude * math::exp(-truth.damping_ratio * w * t) *
                                        math::cos(w * math::sqrt(1.0 - math::square(truth.damping_ratio)) * t) +
                                    noise * normal(random));
  }
}

Identification identified(size_t count, double rate_hz = kRateHz) {
  IdentifyConfig config;
  config.rate_hz = rate_hz;
  Identification found{};
  TEST_ASSERT_OK(identify({samples, count}, config, IdentifyScratch(memory), found));
  return found;
}

}  // namespace

TEST(a_clean_mode_is_found_exactly) {
  ring({11.0, 0.05, 2.0}, 0.0, kSamples);
  const Identification found = identified(kSamples);
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, found.finding);
  TEST_ASSERT_EQUAL_UINT64(1, found.mode_count);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-6, 11.0, found.mode[0].frequency_hz);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-5, 0.05, found.mode[0].damping_ratio);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-5, 2.0, found.mode[0].amplitude);
  TEST_ASSERT_TRUE(found.mode[0].viscous);
  TEST_ASSERT_AT_LEAST_DOUBLE(0.99, found.confidence);
}

TEST(a_noisy_mode_is_found_within_what_it_says) {
  ring({11.0, 0.05, 1.0}, 0.05, kSamples);
  const Identification found = identified(kSamples);
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, found.finding);
  const IdentifiedMode& mode = found.mode[0];
  TEST_ASSERT_DOUBLE_WITHIN(4.0 * mode.frequency_std_hz, 11.0, mode.frequency_hz);
  TEST_ASSERT_DOUBLE_WITHIN(4.0 * mode.damping_std, 0.05, mode.damping_ratio);
  TEST_ASSERT_AT_MOST_DOUBLE(0.1, mode.frequency_std_hz);
  TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.05, found.noise);
}

// Neither the unit of the record nor of time matters.
TEST(the_answer_scales) {
  ring({11.0, 0.05, 1.0}, 0.05, kSamples);
  const Identification here = identified(kSamples);
  for (float& sample : samples) sample *= 1048576.0F;  // a power of two: the same digits
  const Identification there = identified(kSamples, 16.0 * kRateHz);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 16.0 * here.mode[0].frequency_hz, there.mode[0].frequency_hz);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, here.mode[0].damping_ratio, there.mode[0].damping_ratio);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 1048576.0 * here.mode[0].amplitude, there.mode[0].amplitude);
}

// Of every compiler and on the chip. They change only with the method itself; say why in the commit.
TEST(the_answer_has_the_same_bits_everywhere) {
  ring({11.0, 0.05, 1.0}, 0.05, kSamples);
  const IdentifiedMode mode = identified(kSamples).mode[0];
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x40260571310FFF50), math::bits_of(mode.frequency_hz));
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x3FA9B7F1F5CD0894), math::bits_of(mode.damping_ratio));
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x3F531C61A3451A48), math::bits_of(mode.damping_std));
}

TEST(what_does_not_ring_is_no_mode) {
  for (float& sample : samples) sample = 3.3F;
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoMode, identified(kSamples).finding);
  for (float& sample : samples) sample = 0.0F;
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoMode, identified(kSamples).finding);
  for (size_t n = 0; n < kSamples; ++n) samples[n] = 0.3F * static_cast<float>(n) - 20.0F;
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoMode, identified(kSamples).finding);
  ring({50.0, 0.0, 1.0}, 0.02, kSamples);
  const Identification hum = identified(kSamples);
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoMode, hum.finding);
  TEST_ASSERT_EQUAL_UINT64(0, hum.mode_count);
  TEST_ASSERT_DOUBLE_WITHIN(0.01, 50.0, hum.hum_hz);
}

TEST(a_record_of_two_periods_is_too_short) {
  ring({11.0, 0.05, 1.0}, 0.001, 46);
  TEST_ASSERT_EQUAL_ENUM(Finding::kTooShort, identified(46).finding);
  TEST_ASSERT_EQUAL_ENUM(Finding::kTooShort, identified(31).finding);
  TEST_ASSERT_EQUAL_ENUM(Finding::kTooShort, identified(0).finding);
}

TEST(a_record_that_is_cut_off_is_saturated) {
  ring({11.0, 0.03, 1.0}, 0.01, kSamples);
  for (float& sample : samples) sample = sample > 7.6F ? 7.6F : sample;
  TEST_ASSERT_EQUAL_ENUM(Finding::kSaturated, identified(kSamples).finding);
}

// A smooth top that looks flat because the sensor is coarse is none.
TEST(a_coarse_sensor_is_not_saturated) {
  for (int steps = 6; steps <= 2000; steps = 3 * steps / 2) {
    ring({3.0, 0.02, 1.0}, 0.0, kSamples);
    for (float& sample : samples) {
      sample = static_cast<float>(math::floor(static_cast<double>(sample) * steps + 0.5)) / static_cast<float>(steps);
    }
    TEST_INFO(steps, steps);
    TEST_ASSERT_FALSE(is_saturated({samples, kSamples}));
  }
}

TEST(bad_input_is_refused_by_name) {
  ring({11.0, 0.05, 1.0}, 0.0, kSamples);
  Identification found{};
  found.mode_count = 3;
  IdentifyConfig config;
  const auto attempt = [&](size_t count) { return identify({samples, count}, config, IdentifyScratch(memory), found); };
  TEST_ASSERT_REFUSED(kNotPositive, kFrequency, attempt(kSamples));
  config.rate_hz = kRateHz;
  config.most_modes = 5;
  TEST_ASSERT_REFUSED(kAboveMaximum, kStages, attempt(kSamples));
  config.most_modes = 0;
  TEST_ASSERT_REFUSED(kBelowMinimum, kStages, attempt(kSamples));
  config.most_modes = 1;
  config.least_amplitude = math::kNan;
  TEST_ASSERT_REFUSED(kBelowMinimum, kTolerance, attempt(kSamples));
  config.least_amplitude = 0.0;
  TEST_ASSERT_REFUSED(kAboveMaximum, kSamples, attempt(kSamples + 1));
  samples[17] = static_cast<float>(math::kInfinity);
  TEST_ASSERT_REFUSED(kNotFinite, kSamples, attempt(kSamples));
  TEST_ASSERT_EQUAL_UINT64(3, found.mode_count);
}

// The method's own bias: the bin's width in frequency, the band-pass's transient in damping.
TEST(the_decrement_of_a_clean_mode_is_near) {
  ring({11.0, 0.03, 1.0}, 0.0, kSamples);
  DecrementConfig config;
  config.rate_hz = kRateHz;
  config.most_modes = 1;
  DecrementModes modes{};
  TEST_ASSERT_OK(identify_by_decrement({samples, kSamples}, config, memory.buffer, kSamples, modes));
  TEST_ASSERT_EQUAL_UINT64(1, modes.count);
  TEST_ASSERT_DOUBLE_WITHIN(0.5 * kRateHz / kSamples, 11.0, modes.mode[0].frequency_hz);
  TEST_ASSERT_DOUBLE_RELATIVE(0.15, 0.03, modes.mode[0].damping_ratio);
  config.low_pass_hz = kRateHz;
  TEST_ASSERT_REFUSED(kAboveMaximum, kFrequency,
                      identify_by_decrement({samples, kSamples}, config, memory.buffer, kSamples, modes));
}

// A ramp for 200 samples, then steps of a third of its speed's hundredth: rest begins two windows after the ramp.
TEST(rest_begins_when_the_axis_stands) {
  for (size_t n = 0; n < kSamples; ++n) samples[n] = n < 200 ? 0.01F * static_cast<float>(n) : 2.0F;
  samples[300] = 2.0005F;
  const size_t start = quiet_start({samples, kSamples}, 20);
  TEST_ASSERT_AT_LEAST_INT64(200, start);
  TEST_ASSERT_AT_MOST_INT64(245, start);
  for (size_t n = 0; n < kSamples; ++n) samples[n] = static_cast<float>(n);
  TEST_ASSERT_EQUAL_UINT64(kSamples, quiet_start({samples, kSamples}, 20));
  for (float& sample : samples) sample = 1.0F;
  TEST_ASSERT_EQUAL_UINT64(0, quiet_start({samples, kSamples}, 20));
}
