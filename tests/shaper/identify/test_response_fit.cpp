// SPDX-License-Identifier: Apache-2.0
// Answers of arms without delay, which need no libm, and what must be refused.
#include "shaper/identify/response_fit.hpp"

#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr size_t kCount = 24;
ResponseScratch scratch;
Identification result;

struct Answers {
  BinAnswer bin[kCount];

  // From 2 Hz on, each 15 % above the last: 1 + share times the mode's own, times w^2.
  Answers(double frequency_hz, double damping_ratio, double share) {
    double at = 2.0;
    for (BinAnswer& answer : bin) {
      const double x = at / frequency_hz;
      const double in_phase = 1.0 - x * x;
      const double lag = 2.0 * damping_ratio * x;
      const double square = in_phase * in_phase + lag * lag;
      answer.frequency_hz = at;
      answer.re = -at * at * (1.0 - share + share * in_phase / square);
      answer.im = at * at * share * lag / square;
      answer.spread = 1e-3 * at * at;
      at *= 1.15;
    }
  }
};

ResponseConfig accelerometer() { return ResponseConfig{2, 0.0, 1}; }

Status identify(const Answers& answers, const ResponseConfig& config = accelerometer(), size_t count = kCount) {
  return identify_response(answers.bin, count, config, scratch, result);
}

}  // namespace

TEST(a_well_damped_arm_is_found) {
  const Answers answers(9.0, 0.25, 0.8);
  TEST_ASSERT_OK(identify(answers));
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, result.finding);
  TEST_ASSERT_EQUAL_UINT32(1, result.mode_count);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-4, 9.0, result.mode[0].frequency_hz);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-3, 0.25, result.mode[0].damping_ratio);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-3, 0.8 * 81.0, result.mode[0].amplitude);
  TEST_ASSERT_TRUE(result.mode[0].viscous);
  TEST_ASSERT_AT_LEAST_DOUBLE(0.9, result.confidence);
}

TEST(a_lightly_damped_arm_between_two_bins_is_found) {
  const Answers answers(9.9, 0.01, 1.0);
  TEST_ASSERT_OK(identify(answers));
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, result.finding);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-4, 9.9, result.mode[0].frequency_hz);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-2, 0.01, result.mode[0].damping_ratio);
}

TEST(a_rigid_arm_has_no_mode) {
  const Answers answers(9.0, 0.1, 0.0);
  TEST_ASSERT_OK(identify(answers));
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoMode, result.finding);
  TEST_ASSERT_EQUAL_UINT32(0, result.mode_count);
}

TEST(zeros_have_no_mode) {
  Answers answers(9.0, 0.1, 0.0);
  for (BinAnswer& bin : answers.bin) bin.re = bin.im = bin.spread = 0.0;
  TEST_ASSERT_OK(identify(answers));
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoMode, result.finding);
}

TEST(answers_without_spreads_do_as_well) {
  Answers answers(9.0, 0.25, 0.8);
  for (BinAnswer& bin : answers.bin) bin.spread = 0.0;
  TEST_ASSERT_OK(identify(answers));
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, result.finding);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-4, 9.0, result.mode[0].frequency_hz);
}

TEST(one_answer_that_claims_to_be_exact_does_not_rule) {
  Answers answers(9.0, 0.25, 0.8);
  for (BinAnswer& bin : answers.bin) bin.spread *= 10.0;
  answers.bin[5].spread = 0.0;
  answers.bin[5].re *= 1.01;
  TEST_ASSERT_OK(identify(answers));
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, result.finding);
  TEST_ASSERT_DOUBLE_RELATIVE(5e-3, 9.0, result.mode[0].frequency_hz);
}

TEST(too_few_answers_are_too_short) {
  const Answers answers(9.0, 0.25, 0.8);
  TEST_ASSERT_OK(identify(answers, accelerometer(), kLeastAnswers - 1));
  TEST_ASSERT_EQUAL_ENUM(Finding::kTooShort, result.finding);
}

TEST(what_is_not_valid_is_refused_and_the_result_stays) {
  Answers answers(9.0, 0.25, 0.8);
  TEST_ASSERT_OK(identify(answers));
  ResponseConfig config = accelerometer();
  config.power = 3;
  TEST_ASSERT_REFUSED(kAboveMaximum, kKind, identify(answers, config));
  config = accelerometer();
  config.most_modes = 0;
  TEST_ASSERT_REFUSED(kBelowMinimum, kStages, identify(answers, config));
  config.most_modes = kMostResponseModes + 1;
  TEST_ASSERT_REFUSED(kAboveMaximum, kStages, identify(answers, config));
  config = accelerometer();
  config.delay_s = -1e-3;
  TEST_ASSERT_REFUSED(kBelowMinimum, kDelay, identify(answers, config));
  answers.bin[3].spread = -1.0;
  TEST_ASSERT_REFUSED(kBelowMinimum, kSamples, identify(answers));
  answers.bin[3].spread = 1.0;
  answers.bin[3].frequency_hz = answers.bin[2].frequency_hz;
  TEST_ASSERT_REFUSED(kBelowMinimum, kFrequency, identify(answers));
  answers.bin[3].frequency_hz = 1e300 * 1e300;
  TEST_ASSERT_REFUSED(kNotFinite, kFrequency, identify(answers));
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, result.finding);
  TEST_ASSERT_EQUAL_UINT32(1, result.mode_count);
}
