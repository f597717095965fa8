// SPDX-License-Identifier: Apache-2.0
// Random arms, analytic in long double and driven by sines; noise and rigid arms, which have no mode.
#include <algorithm>
#include <string>

#include "shaper/identify/response_fit.hpp"
#include "tests/shaper/identify/answers.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

ResponseScratch scratch;

double between_logarithmic(Random& random, double low, double high) {
  return low * std::pow(high / low, random.unit());
}

struct Trial {
  AnsweringArm arm;
  std::vector<double> frequencies;

  Trial(Random& random, size_t modes, double least_damping) {
    const double f = between_logarithmic(random, 2.0, 80.0);
    arm.modes = {{{f, between_logarithmic(random, least_damping, 0.3)}, modes == 1 ? random.between(0.5, 1.0) : 0.9}};
    if (modes == 2) {
      const double second = std::min(f * random.between(2.2, 4.0), 200.0);
      arm.modes.push_back({{second, between_logarithmic(random, least_damping, 0.3)}, 0.1});
    }
    arm.delay_s = random.between(0.0, 2e-3);
    arm.power = random.unit() < 0.7 ? 2 : 0;
    const double high = f * random.between(2.0, 5.0) * (modes == 2 ? 1.6 : 1.0);
    frequencies =
        logarithmic(f * random.between(0.2, 0.6), std::min(high, 400.0), static_cast<size_t>(random.integer(20, 64)));
  }
};

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return INFINITY;
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(part * static_cast<double>(values.size() - 1))];
}

struct Score {
  std::vector<double> frequency, damping;  // relative errors of the first mode
  size_t trials = 0, found = 0, first = 0, second = 0, false_modes = 0, reported = 0, in_frequency = 0, in_damping = 0;

  void take(const Trial& trial, const std::vector<std::complex<double>>& clean, Random& random, double decibels) {
    const NoiseShape shape = random.unit() < 0.5 ? NoiseShape::kRelative : NoiseShape::kFlat;
    const std::vector<BinAnswer> answers = noisy_answers(trial.frequencies, clean, decibels, shape, random);
    Identification result{};
    const ResponseConfig config{trial.arm.power, trial.arm.tick_s, kMostResponseModes};
    TEST_ASSERT_OK(identify_response(answers.data(), answers.size(), config, scratch, result));
    ++trials;
    if (result.finding == Finding::kFound) ++found;
    for (size_t k = 0; k < result.mode_count; ++k) compare(trial.arm, result.mode[k]);
  }

  void compare(const AnsweringArm& arm, const IdentifiedMode& mode) {
    for (size_t i = 0; i < arm.modes.size(); ++i) {
      const Mode& truth = arm.modes[i].mode;
      const double of_frequency = std::abs(mode.frequency_hz - truth.frequency_hz);
      const double of_damping = std::abs(mode.damping_ratio - truth.damping_ratio);
      if (of_frequency > 0.2 * truth.frequency_hz) continue;
      ++(i == 0 ? first : second);
      ++reported;
      in_frequency += of_frequency < mode.frequency_std_hz ? 1 : 0;
      in_damping += of_damping < mode.damping_std ? 1 : 0;
      if (i == 0) {
        frequency.push_back(of_frequency / truth.frequency_hz);
        damping.push_back(of_damping / truth.damping_ratio);
      }
      return;
    }
    ++false_modes;
  }

  void print(const char* what) const {
    const double all = static_cast<double>(reported);
    MESSAGE(std::string(what) << ": " << found << " of " << trials << " found, second mode " << second << ", false "
                              << false_modes << "; f median " << 100.0 * quantile(frequency, 0.5) << " % 95th "
                              << 100.0 * quantile(frequency, 0.95) << " %, zeta " << 100.0 * quantile(damping, 0.5)
                              << " % " << 100.0 * quantile(damping, 0.95) << " %; inside one std f "
                              << static_cast<double>(in_frequency) / all << " zeta "
                              << static_cast<double>(in_damping) / all);
  }

  void check_deviations(double slack) const {
    const double all = static_cast<double>(reported);
    TEST_ASSERT_DOUBLE_WITHIN(slack, 0.683, static_cast<double>(in_frequency) / all);
    TEST_ASSERT_DOUBLE_WITHIN(slack, 0.683, static_cast<double>(in_damping) / all);
  }
};

Score analytic_arms(size_t modes, double least_damping, double decibels, uint64_t seeds) {
  Score score;
  for (uint64_t seed = 1; seed <= seeds; ++seed) {
    Random random(seed);
    const Trial trial(random, modes, least_damping);
    std::vector<std::complex<double>> clean;
    for (const double frequency : trial.frequencies) clean.push_back(analytic(trial.arm, frequency));
    TEST_INFO(seed, seed);
    score.take(trial, clean, random, decibels > 0.0 ? decibels : random.between(20.0, 50.0));
  }
  return score;
}

std::vector<BinAnswer> noise_alone(Random& random) {
  std::vector<BinAnswer> answers;
  const double slope = random.between(-1.0, 2.0);
  const size_t count = static_cast<size_t>(random.integer(kLeastAnswers, 64));
  for (const double frequency : logarithmic(random.between(0.5, 5.0), random.between(20.0, 200.0), count)) {
    const double spread = std::pow(frequency, slope) * random.between(0.5, 2.0);
    const double re = spread * gaussian(random);
    const double im = spread * gaussian(random);
    answers.push_back(BinAnswer{frequency, re, im, spread});
  }
  return answers;
}

}  // namespace

TEST_HOST(one_mode_is_found_as_well_as_the_noise_lets) {
  const Score score = analytic_arms(1, 0.01, 0.0, 1000);
  score.print("one mode, 20 to 50 dB");
  TEST_ASSERT_EQUAL_UINT32(0, score.false_modes);
  TEST_ASSERT_AT_LEAST_INT64(995, score.first);
  TEST_ASSERT_AT_MOST_DOUBLE(0.0005, quantile(score.frequency, 0.5));
  TEST_ASSERT_AT_MOST_DOUBLE(0.005, quantile(score.frequency, 0.95));
  TEST_ASSERT_AT_MOST_DOUBLE(0.005, quantile(score.damping, 0.5));
  TEST_ASSERT_AT_MOST_DOUBLE(0.05, quantile(score.damping, 0.95));
  score.check_deviations(0.06);
}

TEST_HOST(well_damped_arms_are_found) {
  const Score score = analytic_arms(1, 0.15, 0.0, 500);
  score.print("zeta 0.15 to 0.3, 20 to 50 dB");
  TEST_ASSERT_EQUAL_UINT32(0, score.false_modes);
  TEST_ASSERT_AT_LEAST_INT64(497, score.first);
  TEST_ASSERT_AT_MOST_DOUBLE(0.01, quantile(score.frequency, 0.95));
  TEST_ASSERT_AT_MOST_DOUBLE(0.05, quantile(score.damping, 0.95));
  score.check_deviations(0.06);
}

TEST_HOST(two_modes_are_told_apart) {
  const Score score = analytic_arms(2, 0.01, 0.0, 1000);
  score.print("two modes, 20 to 50 dB");
  TEST_ASSERT_AT_MOST_INT64(5, score.false_modes);  // 0 and 2, with two orders of the draws
  TEST_ASSERT_AT_LEAST_INT64(985, score.first);
  TEST_ASSERT_AT_LEAST_INT64(950, score.second);
  TEST_ASSERT_AT_MOST_DOUBLE(0.005, quantile(score.frequency, 0.95));
  TEST_ASSERT_AT_MOST_DOUBLE(0.06, quantile(score.damping, 0.95));
  score.check_deviations(0.06);
}

// Delay and interpolation leave no bias: at 60 dB errors are still the noise's.
TEST_HOST(delay_and_interpolation_do_not_bias) {
  const Score score = analytic_arms(2, 0.01, 60.0, 500);
  score.print("two modes, 60 dB");
  TEST_ASSERT_EQUAL_UINT32(0, score.false_modes);
  TEST_ASSERT_AT_MOST_DOUBLE(5e-5, quantile(score.frequency, 0.5));
  TEST_ASSERT_AT_MOST_DOUBLE(5e-4, quantile(score.frequency, 0.95));
  TEST_ASSERT_AT_MOST_DOUBLE(0.005, quantile(score.damping, 0.95));
}

TEST_HOST(simulated_arms_driven_by_sines_are_found) {
  Score score;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const Trial trial(random, 1 + seed % 2, 0.01);
    std::vector<std::complex<double>> clean;
    for (const double frequency : trial.frequencies) clean.push_back(driven(trial.arm, frequency));
    TEST_INFO(seed, seed);
    score.take(trial, clean, random, random.between(20.0, 50.0));
  }
  score.print("simulated, 20 to 50 dB");
  TEST_ASSERT_EQUAL_UINT32(0, score.false_modes);
  TEST_ASSERT_AT_LEAST_INT64(59, score.first);
  TEST_ASSERT_AT_MOST_DOUBLE(0.01, quantile(score.frequency, 0.95));
  TEST_ASSERT_AT_MOST_DOUBLE(0.06, quantile(score.damping, 0.95));
  score.check_deviations(0.15);
}

// The transfer the oracle writes down is the one the simulated arm has.
TEST_HOST(the_analytic_position_is_the_simulated_one) {
  Random random(5);
  for (int n = 0; n < 20; ++n) {
    Trial trial(random, 2, 0.02);
    trial.arm.power = 0;
    trial.arm.delay_s = trial.arm.tick_s;
    const double frequency = trial.frequencies[static_cast<size_t>(random.integer(0, 19))];
    const std::complex<double> expected = analytic(trial.arm, frequency);
    TEST_ASSERT_AT_MOST_DOUBLE(2e-3 * std::abs(expected), std::abs(expected - driven(trial.arm, frequency)));
  }
}

TEST_HOST(noise_alone_is_never_a_mode) {
  size_t found = 0, unclear = 0;
  for (uint64_t seed = 1; seed <= 1000; ++seed) {
    Random random(seed);
    const std::vector<BinAnswer> answers = noise_alone(random);
    Identification result{};
    const uint32_t power = random.unit() < 0.5 ? 2 : 0;
    TEST_ASSERT_OK(identify_response(answers.data(), answers.size(), {power, 1e-3, 3}, scratch, result));
    found += result.finding == Finding::kFound ? 1 : 0;
    unclear += result.finding == Finding::kNoisy ? 1 : 0;
  }
  MESSAGE("noise: found " << found << ", noisy " << unclear << " of 1000");
  TEST_ASSERT_EQUAL_UINT32(0, found);
  TEST_ASSERT_AT_MOST_INT64(20, unclear);
}

namespace {

// How many of 600 rigid arms are said to have a mode, and not to be clear; `told` is what is said of their spreads.
struct RigidArms {
  int64_t found = 0, unclear = 0;

  explicit RigidArms(double told) {
    for (uint64_t seed = 1; seed <= 600; ++seed) {
      Random random(seed);
      Trial trial(random, 1, 0.01);
      trial.arm.modes.clear();
      std::vector<std::complex<double>> clean;
      for (const double frequency : trial.frequencies) clean.push_back(analytic(trial.arm, frequency));
      const NoiseShape shape = random.unit() < 0.5 ? NoiseShape::kRelative : NoiseShape::kFlat;
      const double decibels = random.between(10.0, 100.0);
      std::vector<BinAnswer> answers = noisy_answers(trial.frequencies, clean, decibels, shape, random);
      for (BinAnswer& answer : answers) answer.spread *= told;
      Identification result{};
      const ResponseConfig config{trial.arm.power, trial.arm.tick_s, kMostResponseModes};
      TEST_ASSERT_OK(identify_response(answers.data(), answers.size(), config, scratch, result));
      found += result.finding == Finding::kFound ? 1 : 0;
      unclear += result.finding == Finding::kNoisy ? 1 : 0;
    }
    MESSAGE("rigid, spreads times " << told << ": found " << found << ", noisy " << unclear << " of 600");
  }
};

}  // namespace

TEST_HOST(a_rigid_arm_has_no_mode) {
  const RigidArms arms(1.0);
  TEST_ASSERT_EQUAL_INT64(0, arms.found);
  TEST_ASSERT_AT_MOST_INT64(6, arms.unclear);
}

// Then no more can be asked than that hardly ever a mode is made up: 1 in 100.
TEST_HOST(a_rigid_arm_has_no_mode_where_the_spreads_are_too_small_or_missing) {
  TEST_ASSERT_AT_MOST_INT64(6, RigidArms(0.1).found);
  TEST_ASSERT_AT_MOST_INT64(6, RigidArms(0.0).found);
}
