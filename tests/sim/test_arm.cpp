// SPDX-License-Identifier: Apache-2.0
// The arm against integrators of another kind.
#include <cmath>
#include <vector>

#include "sim/plant/arm.hpp"
#include "tests/support/test.hpp"

using stillpoint::Mode;
using stillpoint::sim::Arm;
using stillpoint::sim::ArmModes;
using stillpoint::testing::Random;

namespace {

constexpr double kTick = 1e-3;
constexpr long double kTwoPi = 6.283185307179586476925286766559L;

// One mode in absolute coordinates, x'' = w^2 (u - x) - 2 zeta w x', by Runge and Kutta's fourth-order steps.
class RungeKutta {
 public:
  explicit RungeKutta(const Mode& mode)
      : w_(kTwoPi * static_cast<long double>(mode.frequency_hz)), zeta_(static_cast<long double>(mode.damping_ratio)) {}

  void step(long double increment, long double tick, int parts) {
    const long double h = tick / static_cast<long double>(parts);
    slope_ = increment / tick;
    for (int i = 0; i < parts; ++i) {
      const long double u = u_ + slope_ * h * static_cast<long double>(i);
      const long double k1 = pull(u, x_, v_);
      const long double k2 = pull(u + slope_ * h / 2, x_ + h / 2 * v_, v_ + h / 2 * k1);
      const long double k3 = pull(u + slope_ * h / 2, x_ + h / 2 * v_ + h * h / 4 * k1, v_ + h / 2 * k2);
      const long double k4 = pull(u + slope_ * h, x_ + h * v_ + h * h / 2 * k2, v_ + h * k3);
      x_ += h * v_ + h * h / 6 * (k1 + k2 + k3);
      v_ += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    u_ += increment;
  }

  long double deflection() const { return x_ - u_; }
  long double velocity() const { return v_; }
  long double acceleration() const { return pull(u_, x_, v_); }

 private:
  long double pull(long double u, long double x, long double v) const { return w_ * w_ * (u - x) - 2 * zeta_ * w_ * v; }

  long double w_, zeta_;
  long double u_ = 0, slope_ = 0, x_ = 0, v_ = 0;
};

double as_double(long double value) { return static_cast<double>(value); }

// Largest differences over a random walk of the motor, relative to the largest values.
void check_against_runge_kutta(const Mode& mode, uint64_t seed) {
  TEST_INFO(frequency, mode.frequency_hz);
  TEST_INFO(damping, mode.damping_ratio);
  Random random(seed);
  Arm arm({{mode, 1.0}}, kTick);
  RungeKutta oracle(mode);
  double scale[3] = {1e-30, 1e-30, 1e-30};
  double error[3] = {};
  for (int tick = 0; tick < 200; ++tick) {
    const double increment = random.between(-1.0, 1.0);
    arm.step(increment);
    oracle.step(static_cast<long double>(increment), static_cast<long double>(kTick), 1024);
    const double expected[3] = {as_double(oracle.deflection()), as_double(oracle.velocity()),
                                as_double(oracle.acceleration())};
    const double actual[3] = {arm.deflection(), arm.velocity(), arm.acceleration()};
    for (int i = 0; i < 3; ++i) {
      scale[i] = std::max(scale[i], std::abs(expected[i]));
      error[i] = std::max(error[i], std::abs(expected[i] - actual[i]));
    }
  }
  for (int i = 0; i < 3; ++i) TEST_ASSERT_AT_MOST_DOUBLE(1e-9 * scale[i], error[i]);
}

}  // namespace

TEST_HOST(an_arm_moves_as_small_steps_of_another_integrator_say) {
  uint64_t seed = 1;
  for (const double frequency : {0.5, 3.0, 11.0, 37.3, 150.0, 400.0}) {
    for (const double damping : {0.0, 0.01, 0.11, 0.5, 0.99}) {
      check_against_runge_kutta({frequency, damping}, seed++);
    }
  }
}

TEST_HOST(a_step_of_the_motor_rings_as_the_closed_form_says) {
  // GIVEN an arm whose motor has moved by one within one short tick, which is nearly a step.
  const double damping = 0.11;
  const double w = as_double(kTwoPi) * 11.0;
  const double wd = w * std::sqrt(1.0 - damping * damping);
  constexpr double kShort = 1e-7;
  Arm moved({{{11.0, damping}, 1.0}}, kShort);
  moved.step(1.0);
  // WHEN it is left alone THEN the tip goes as 1 - exp(-zeta w t) (cos wd t + zeta w / wd sin wd t).
  Arm arm = moved.released(kTick);
  for (int tick = 1; tick <= 500; ++tick) {
    arm.step(0.0);
    const double t = kShort / 2.0 + tick * kTick;
    const double expected = -std::exp(-damping * w * t) * (std::cos(wd * t) + damping * w / wd * std::sin(wd * t));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, expected, arm.deflection());
  }
}

TEST_HOST(many_small_steps_end_where_one_large_step_does) {
  // GIVEN the same motion of the motor, a ramp of 64 ms, in steps of 1 ms and of 64 ms.
  Arm fine({{{11.0, 0.11}, 0.6}, {{63.0, 0.02}, 0.3}}, kTick);
  Arm coarse({{{11.0, 0.11}, 0.6}, {{63.0, 0.02}, 0.3}}, 64.0 * kTick);
  for (int i = 0; i < 64; ++i) fine.step(1.0 / 64.0);
  coarse.step(1.0);
  // THEN the transition is exact over either.
  TEST_ASSERT_DOUBLE_WITHIN(1e-13, coarse.deflection(), fine.deflection());
  TEST_ASSERT_DOUBLE_WITHIN(1e-11, coarse.velocity(), fine.velocity());
  // The rigid tenth accelerates at the ramp's beginning only: left out of the last fine step, in the coarse one.
  TEST_ASSERT_DOUBLE_WITHIN(1e-8, coarse.acceleration() - 0.1 / (64e-3 * 64e-3), fine.acceleration());
}

TEST_HOST(an_undamped_arm_keeps_its_energy_for_a_million_ticks) {
  Arm arm({{{11.0, 0.0}, 1.0}}, kTick);
  arm.step(1.0);
  arm = arm.released(kTick);
  const double before = arm.acceleration_envelope();
  for (int i = 0; i < 1000000; ++i) arm.step(0.0);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, before, arm.acceleration_envelope());
}

TEST_HOST(a_damped_arm_loses_amplitude_at_the_rate_of_its_damping) {
  for (const double damping : {0.001, 0.05, 0.11, 0.3, 0.9, 0.99}) {
    TEST_INFO(damping_ratio, damping);
    Arm arm({{{7.0, damping}, 1.0}}, kTick);
    arm.step(1.0);
    arm = arm.released(kTick);
    const double rate = damping * as_double(kTwoPi) * 7.0;
    double amplitude = arm.acceleration_envelope();
    for (int i = 0; i < 200; ++i) {
      arm.step(0.0);
      const double expected = amplitude * std::exp(-rate * kTick);
      TEST_ASSERT_DOUBLE_RELATIVE(1e-9, expected, arm.acceleration_envelope());
      TEST_ASSERT_AT_MOST_DOUBLE(arm.acceleration_envelope() * (1.0 + 1e-9), std::abs(arm.acceleration()));
      amplitude = arm.acceleration_envelope();
    }
  }
}

TEST_HOST(the_tip_is_the_sum_of_the_modes_by_their_shares) {
  // GIVEN two modes of shares 0.5 and 0.2, so that three tenths move rigidly.
  const ArmModes both = {{{11.0, 0.11}, 0.5}, {{90.0, 0.03}, 0.2}};
  Arm arm(both, kTick);
  Arm first({{{11.0, 0.11}, 1.0}}, kTick);
  Arm second({{{90.0, 0.03}, 1.0}}, kTick);
  Arm rigid({}, kTick);
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const double increment = random.between(-1.0, 1.0);
    for (Arm* each : {&arm, &first, &second, &rigid}) each->step(increment);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5 * first.deflection() + 0.2 * second.deflection(), arm.deflection());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * first.velocity() + 0.2 * second.velocity() + 0.3 * rigid.velocity(),
                              arm.velocity());
    TEST_ASSERT_DOUBLE_WITHIN(1e-5,
                              0.5 * first.acceleration() + 0.2 * second.acceleration() + 0.3 * rigid.acceleration(),
                              arm.acceleration());
  }
}

TEST_HOST(an_arm_at_rest_stays_there) {
  Arm arm({{{11.0, 0.11}, 1.0}}, kTick);
  for (int i = 0; i < 1000; ++i) arm.step(0.0);
  TEST_ASSERT_TRUE(arm.deflection() == 0.0 && arm.velocity() == 0.0 && arm.acceleration() == 0.0);
  arm.step(1.0);
  arm.reset();
  TEST_ASSERT_TRUE(arm.deflection() == 0.0 && arm.velocity() == 0.0 && arm.acceleration() == 0.0);
}

TEST_HOST(modes_that_are_none_are_refused) {
  using stillpoint::Error;
  const double nan = std::nan("");
  TEST_ASSERT_OK(validate(ArmModes{}));
  TEST_ASSERT_OK(validate(ArmModes{{{11.0, 0.1}, 0.7}, {{20.0, 0.1}, 0.3}}));
  TEST_ASSERT_EQUAL_ENUM(Error::kAboveMaximum, validate(ArmModes{{{11.0, 0.1}, 0.8}, {{20.0, 0.1}, 0.3}}).error);
  TEST_ASSERT_EQUAL_ENUM(Error::kNotPositive, validate(ArmModes{{{11.0, 0.1}, 0.0}}).error);
  TEST_ASSERT_EQUAL_ENUM(Error::kNotFinite, validate(ArmModes{{{11.0, 0.1}, nan}}).error);
  TEST_ASSERT_FALSE(validate(ArmModes{{{0.0, 0.1}, 1.0}}).ok());
  TEST_ASSERT_FALSE(validate(ArmModes{{{11.0, 1.0}, 1.0}}).ok());
}
