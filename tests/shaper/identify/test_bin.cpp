// SPDX-License-Identifier: Apache-2.0
// Answers that are known, with what a sensor adds to them.
#include "shaper/identify/bin.hpp"

#include "shaper/base/complex.hpp"
#include "shaper/identify/quadrature.hpp"
#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;
constexpr uint32_t kSteps = 4;

TEST(a_quadrature_pair_is_a_sine_and_a_cosine) {
  testing::Random random(7);
  for (int i = 0; i < 3000; ++i) {
    const uint32_t phase = i < 8 ? static_cast<uint32_t>(i) << 29 : static_cast<uint32_t>(random.next());
    const Quadrature pair = quadrature_of(phase);
    const double angle = 2.0 * math::kPi * (phase / 4294967296.0);
    TEST_INFO(phase, phase);
    TEST_ASSERT_DOUBLE_WITHIN(0.51, 32768.0 * math::sin(angle), pair.sine);
    TEST_ASSERT_DOUBLE_WITHIN(0.51, 32768.0 * math::cos(angle), pair.cosine);
  }
}

// A sensor that reads 1000 steps a count times the answer, and whatever is added.
struct Hearing {
  static constexpr double kUnit = 1000.0;
  Excitation excitation{};
  SteppedBins bins{};
  BinAnswer answers[kSteps];
  Complex answer{0.3, -0.7};

  Hearing() {
    Announcement announced{};
    const ExcitationConfig config{ExcitationKind::kSteppedSine, kTick, 100.0, 200.0, 1e6, 1e9, 1e12, 9.0, 31.0, kSteps};
    TEST_ASSERT_OK(excitation.prepare(config, announced));
  }

  // `added`(tick of all, tick since the step is held).
  template <typename Added>
  void hear(const Added& added) {
    bins.start();
    excitation.start();
    uint32_t held = 0;
    for (uint32_t n = 0; !excitation.over(); ++n) {
      const double angle = 2.0 * math::kPi * (excitation.phase() / 4294967296.0);
      const double amplitude = kUnit * excitation.amplitude(excitation.step());
      const double clean = amplitude * (answer.re * math::sin(angle) + answer.im * math::cos(angle));
      held = excitation.held() ? held + 1 : 0;
      bins.tick(excitation, math::nearest_integer(clean + added(n, held)));
      static_cast<void>(excitation.tick());
    }
  }
  void check(double tolerance, const Identification& known = {}) {
    bins.answers(excitation, kTick, known, answers);
    for (uint32_t k = 0; k < kSteps; ++k) {
      TEST_INFO(k, k);
      TEST_ASSERT_DOUBLE_RELATIVE(1e-9, excitation.cycles_a_tick(k) / kTick, answers[k].frequency_hz);
      TEST_ASSERT_DOUBLE_WITHIN(tolerance * kUnit, kUnit * answer.re, answers[k].re);
      TEST_ASSERT_DOUBLE_WITHIN(tolerance * kUnit, kUnit * answer.im, answers[k].im);
    }
  }
};

TEST_F(Hearing, a_clean_answer_is_read_off) {
  hear([](uint32_t, uint32_t) { return 0.0; });
  check(5e-5);
  for (const BinAnswer& one : answers) TEST_ASSERT_AT_MOST_DOUBLE(1e-4 * kUnit, one.spread);
}

// Ten times the amplitude, and 50 times over the whole sine.
TEST_F(Hearing, an_offset_and_a_drift_come_off) {
  hear([this](uint32_t n, uint32_t) { return 1e6 + 5e6 * n / excitation.ticks(); });
  check(2e-4);
}

TEST_F(Hearing, the_ringing_of_a_known_mode_comes_off) {
  Identification known{};
  known.mode_count = 1;
  known.mode[0].frequency_hz = 14.0;
  known.mode[0].damping_ratio = 0.05;
  const double angle = 2.0 * math::kPi * 14.0 * kTick;
  const Complex rate{-0.05 * angle, angle * math::sqrt(1.0 - 0.0025)};
  hear([&](uint32_t, uint32_t held) { return 8e4 * math::exp(static_cast<double>(held) * rate).re; });
  check(2e-4, known);
  // And would matter.
  Identification none{};
  bins.answers(excitation, kTick, none, answers);
  const double off = math::abs(answers[1].re - kUnit * answer.re) + math::abs(answers[1].im - kUnit * answer.im);
  TEST_ASSERT_AT_LEAST_DOUBLE(0.03 * kUnit, off);
}

// 600 answers, each part: a deviation within and without one spread as a normal one has it.
TEST_F(Hearing, spreads_are_true) {
  testing::Random random(11);
  int inside = 0, all = 0;
  for (int run = 0; run < 75; ++run) {
    hear([&](uint32_t, uint32_t) {
      double sum = 0.0;
      for (int i = 0; i < 4; ++i) sum += random.between(-1e5, 1e5);
      return sum;
    });
    Identification none{};
    bins.answers(excitation, kTick, none, answers);
    for (const BinAnswer& one : answers) {
      inside += math::abs(one.re - kUnit * answer.re) < one.spread ? 1 : 0;
      inside += math::abs(one.im - kUnit * answer.im) < one.spread ? 1 : 0;
      all += 2;
    }
  }
  TEST_INFO(inside, inside);
  TEST_ASSERT_DOUBLE_WITHIN(0.06, 0.66, 1.0 * inside / all);  // Student's t with ten degrees: 0.659
}

}  // namespace
