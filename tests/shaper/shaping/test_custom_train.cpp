// SPDX-License-Identifier: Apache-2.0
// The caller's own train on the ticks.
#include "shaper/shaping/prototype.hpp"
#include "tests/shaper/shaping/residual_oracle.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::impulses_of;
using stillpoint::testing::Random;
using stillpoint::testing::residual_ratio;

namespace {

constexpr double kTick = 1e-3;
constexpr double kUnity = kUnityGain;

ShaperDesign designed(const ImpulseTrain& train, const Mode& mode) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperSpec{ShaperKind::kCustom, mode, 0.0, 0.0, &train}, kTick, design));
  int64_t sum = 0;
  for (uint32_t i = 0; i < design.tap_count; ++i) sum += design.taps[i].gain;
  TEST_ASSERT_EQUAL_INT64(kUnityGain, sum);
  TEST_ASSERT_EQUAL_UINT32(1, design.stage_count);
  return design;
}

double gain_at(const ShaperDesign& design, uint32_t tick) {
  double sum = 0.0;
  for (uint32_t i = 0; i < design.tap_count; ++i) {
    if (design.taps[i].delay_ticks == tick) sum += design.taps[i].gain / kUnity;
  }
  return sum;
}

// V of the caller's train at a mode, apart from the ticks.
double residual_of(const ImpulseTrain& train, const Mode& mode) {
  Cascade cascade{};
  cascade.add(train.impulses, train.count);
  return static_cast<double>(residual_ratio(cascade, mode.frequency_hz, mode.damping_ratio));
}

// The stage may end a tick after the train: V counts from the last impulse.
double residual_on_ticks(const ShaperDesign& design, const ImpulseTrain& train, const Mode& mode) {
  const Cascade taps = impulses_of(design);
  const double late = taps.impulses[taps.impulse_count - 1].time * kTick - train.impulses[train.count - 1].time;
  const double w = 2.0 * math::kPi * mode.frequency_hz;
  return static_cast<double>(residual_ratio(taps, mode.frequency_hz * kTick, mode.damping_ratio)) *
         math::exp(mode.damping_ratio * w * late);
}

ImpulseTrain random_train(Random& random, uint32_t count, double spread_s) {
  ImpulseTrain train{count, {}};
  double sum = 0.0;
  for (uint32_t i = 0; i < count; ++i) {
    train.impulses[i].time = i == 0 ? 0.0 : train.impulses[i - 1].time + spread_s * random.between(0.2, 1.0);
    sum += train.impulses[i].amplitude = random.between(0.1, 1.0);
  }
  for (uint32_t i = 0; i < count; ++i) train.impulses[i].amplitude /= sum;
  return train;
}

}  // namespace

TEST(a_train_on_the_ticks_stays_as_it_is) {
  const uint64_t seed = 5;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int n = 0; n < 20; ++n) {
    ImpulseTrain train = random_train(random, 2 + static_cast<uint32_t>(n) / 2, 0.02);
    for (uint32_t i = 0; i < train.count; ++i) {
      train.impulses[i].time = kTick * math::floor(train.impulses[i].time / kTick);
    }
    const ShaperDesign design = designed(train, Mode{9.0, 0.05});
    double on_ticks = 0.0;
    for (uint32_t i = 0; i < train.count; ++i) {
      const auto tick = static_cast<uint32_t>(train.impulses[i].time / kTick + 0.5);
      const double allowed = (i == 0 ? 0.5 * train.count : 0.5) / kUnity * (1.0 + 1e-3);
      TEST_ASSERT_DOUBLE_WITHIN(allowed, train.impulses[i].amplitude, gain_at(design, tick));
      on_ticks += gain_at(design, tick);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 1.0, on_ticks);
  }
}

// Zero by design, off the ticks: the impulses of ZV.
TEST(a_zero_by_design_stays_a_zero) {
  constexpr double kFrequencies[] = {0.7, 11.0, 37.3, 120.0};
  for (const double frequency_hz : kFrequencies) {
    TEST_INFO("frequency", frequency_hz);
    const Mode mode{frequency_hz, 0.11};
    const double root = math::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio);
    const double k = math::exp(-mode.damping_ratio * math::kPi / root);
    const ImpulseTrain train{2, {{0.0, 1.0 / (1.0 + k)}, {0.5 / (frequency_hz * root), k / (1.0 + k)}}};
    TEST_ASSERT_AT_MOST_DOUBLE(1e-14, residual_of(train, mode));
    TEST_ASSERT_AT_MOST_DOUBLE(1e-6, residual_on_ticks(designed(train, mode), train, mode));
  }
}

TEST(the_transfer_at_the_mode_is_kept_and_amplitudes_are_near_the_linear_split) {
  const uint64_t seed = 6;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int n = 0; n < 12; ++n) {
    const Mode mode{random.between(1.0, 60.0), random.between(0.0, 0.2)};
    const ImpulseTrain train = random_train(random, 2 + static_cast<uint32_t>(n) / 2, 0.03);
    const double wanted = residual_of(train, mode);
    if (wanted < 2e-3) continue;  // below 1e-3 it is made a zero
    const ShaperDesign design = designed(train, mode);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, wanted, residual_on_ticks(design, train, mode));
    // A linear split lowers V by (pi f dt)^2 / 2 at the most: that is what is given back.
    const double angle = math::kPi * mode.frequency_hz * kTick;
    for (uint32_t i = 0; i < train.count; ++i) {
      const double time = train.impulses[i].time / kTick;
      const auto tick = static_cast<uint32_t>(time);
      const double share = train.impulses[i].amplitude * (1.0 - (time - tick));
      TEST_ASSERT_DOUBLE_WITHIN(angle * angle + 1e-8, share, gain_at(design, tick));
    }
  }
}

TEST(a_train_of_the_most_impulses_fits_off_the_ticks_too) {
  const uint64_t seed = 7;
  TEST_INFO("seed", seed);
  Random random(seed);
  const Mode mode{4.0, 0.02};
  const ImpulseTrain train = random_train(random, 31, 0.02);
  const ShaperDesign design = designed(train, mode);
  TEST_ASSERT_EQUAL_UINT32(61, design.tap_count);
  TEST_ASSERT_DOUBLE_WITHIN(1e-7, residual_of(train, mode), residual_on_ticks(design, train, mode));
}

TEST(a_train_with_more_taps_than_a_stage_has_is_refused_by_them) {
  const uint64_t seed = 8;
  TEST_INFO("seed", seed);
  Random random(seed);
  const ImpulseTrain train = random_train(random, 40, 0.02);
  ShaperDesign design{};
  const ShaperSpec spec{ShaperKind::kCustom, Mode{4.0, 0.02}, 0.0, 0.0, &train};
  TEST_ASSERT_REFUSED(kTooManyStages, kTaps, add_shaper(spec, kTick, design));
  TEST_ASSERT_EQUAL_UINT32(0, design.tap_count);
}

// The first gain is found last: on the way there the others may sum to minus two.
TEST(gains_of_either_sign_are_rounded_without_overflow) {
  const ImpulseTrain train{3, {{0.0, 1.5}, {0.01, -1.2}, {0.03, 0.7}}};
  const ShaperDesign design = designed(train, Mode{9.0, 0.05});
  TEST_ASSERT_DOUBLE_WITHIN(2e-9, 1.5, gain_at(design, 0));
  TEST_ASSERT_DOUBLE_WITHIN(2e-9, -1.2, gain_at(design, 10));
  TEST_ASSERT_DOUBLE_WITHIN(2e-9, 0.7, gain_at(design, 30));
}

TEST(a_single_impulse_passes_everything_through) {
  const ImpulseTrain train{1, {{0.0, 1.0}}};
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 1.0, gain_at(designed(train, Mode{9.0, 0.05}), 0));
}
