// SPDX-License-Identifier: Apache-2.0
// The two masses against an integrator of another kind, energy, and what k, m and c say.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/plant/two_masses.hpp"
#include "sim/refusal.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::sim;
using stillpoint::testing::Random;

namespace {

double as_double(long double value) { return static_cast<double>(value); }

// Fourth-order Runge and Kutta in absolute coordinates. With q = x2' - (c / m) x1 the derivative of x1 drops out, so
// a step of x1 is only another value of it, and the damper's kick comes by itself.
class RungeKutta {
 public:
  explicit RungeKutta(const TwoMassParameters& p)
      : k_(static_cast<long double>(p.stiffness_n_per_m) / static_cast<long double>(p.mass_kg)),
        c_(static_cast<long double>(p.damping_n_s_per_m) / static_cast<long double>(p.mass_kg)) {}

  void step(long double step) { near_ += step; }

  void advance(long double duration, int parts) {
    const long double h = duration / static_cast<long double>(parts);
    for (int i = 0; i < parts; ++i) {
      const Slope a = slope(far_, q_);
      const Slope b = slope(far_ + h / 2 * a.far, q_ + h / 2 * a.q);
      const Slope c = slope(far_ + h / 2 * b.far, q_ + h / 2 * b.q);
      const Slope d = slope(far_ + h * c.far, q_ + h * c.q);
      far_ += h / 6 * (a.far + 2 * b.far + 2 * c.far + d.far);
      q_ += h / 6 * (a.q + 2 * b.q + 2 * c.q + d.q);
    }
  }

  long double far_position() const { return far_; }
  long double far_velocity() const { return q_ + c_ * near_; }

 private:
  struct Slope {
    long double far, q;
  };
  Slope slope(long double far, long double q) const {
    const long double velocity = q + c_ * near_;
    return {velocity, k_ * (near_ - far) - c_ * velocity};
  }

  long double k_, c_;
  long double near_ = 0, far_ = 0, q_ = 0;
};

std::string refusal_of(const TwoMassParameters& parameters) {
  try {
    static_cast<void>(TwoMasses(parameters));
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "";
}

}  // namespace

TEST_HOST(the_far_mass_goes_where_small_steps_say) {
  Random random(1401);
  for (int plant = 0; plant < 20; ++plant) {
    const double mass = random.between(0.2, 5.0);
    const TwoMassParameters parameters =
        TwoMassParameters::of({random.between(1.0, 40.0), random.between(0.0, 0.9)}, mass);
    TEST_INFO(plant, plant);
    TwoMasses masses(parameters);
    RungeKutta oracle(parameters);
    for (int i = 0; i < 60; ++i) {
      const auto step = static_cast<long double>(random.between(-1.0, 1.0));
      const auto duration = static_cast<long double>(random.between(0.0, 5e-3));  // off any grid
      masses.step(step);
      oracle.step(step);
      masses.advance(duration);
      oracle.advance(duration, 480);
      TEST_ASSERT_DOUBLE_WITHIN(1e-10, as_double(oracle.far_position()), as_double(masses.far_position()));
      TEST_ASSERT_DOUBLE_WITHIN(1e-8, as_double(oracle.far_velocity()), as_double(masses.far_velocity()));
    }
  }
}

TEST_HOST(a_step_leaves_the_far_mass_and_kicks_it_through_the_damper) {
  TwoMasses masses({2.0, 1000.0, 6.0});
  masses.step(0.5L);
  TEST_ASSERT_TRUE(masses.near_position() == 0.5L && masses.far_position() == 0.0L);
  TEST_ASSERT_DOUBLE_WITHIN(1e-15, 6.0 * 0.5 / 2.0, as_double(masses.far_velocity()));
}

TEST_HOST(without_a_damper_energy_stays) {
  const TwoMassParameters parameters{1.0, 632.0, 0.0};
  TwoMasses masses(parameters);
  masses.step(1.0L);
  for (int i = 0; i < 10000; ++i) {
    masses.advance(1e-3L);
    const long double r = masses.far_position() - masses.near_position();
    const long double v = masses.far_velocity();
    TEST_ASSERT_DOUBLE_RELATIVE(1e-14, 316.0, as_double(316.0L * r * r + 0.5L * v * v));
    TEST_ASSERT_DOUBLE_RELATIVE(1e-14, 1.0, as_double(masses.amplitude()));
  }
}

TEST_HOST(frequency_and_damping_are_those_of_k_m_and_c) {
  const Mode stiff = TwoMassParameters{1.0, 2526.0, 10.05}.mode();  // Park's: 8 Hz, 0.1
  TEST_ASSERT_DOUBLE_WITHIN(2e-3, 8.0, stiff.frequency_hz);
  TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1, stiff.damping_ratio);
  const TwoMassParameters parameters = TwoMassParameters::of({5.0, 0.07}, 3.0);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-14, 5.0, parameters.mode().frequency_hz);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-14, 0.07, parameters.mode().damping_ratio);
  // Seen from outside: extremes half a damped period apart, each lower by exp(-pi zeta / sqrt(1 - zeta^2)).
  TwoMasses masses(parameters);
  masses.step(1.0L);
  std::vector<double> times, extremes;
  long double before = masses.far_velocity();
  for (int i = 1; extremes.size() < 9; ++i) {
    masses.advance(1e-5L);
    const long double now = masses.far_velocity();
    if (before * now < 0.0L) {
      times.push_back(1e-5 * (i - as_double(now / (now - before))));
      extremes.push_back(as_double(masses.far_position() - 1.0L));
    }
    before = now;
  }
  const double root = std::sqrt(1.0 - 0.07 * 0.07);
  TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.1 / root, (times[8] - times[0]) / 8.0);
  TEST_ASSERT_DOUBLE_WITHIN(1e-6, -std::exp(-3.14159265358979 * 0.07 / root), extremes[4] / extremes[3]);
}

TEST_HOST(the_amplitude_is_the_envelope_of_what_follows) {
  TwoMasses masses({1.0, 2526.0, 10.05});
  masses.step(1.0L);
  masses.advance(0.0123L);
  masses.step(-0.4L);
  const long double amplitude = masses.amplitude();
  long double most = 0.0L;
  for (int i = 0; i < 2000; ++i) {
    masses.advance(1e-4L);
    const long double envelope = amplitude * std::exp(-5.025L * 1e-4L * static_cast<long double>(i + 1));
    most = std::max(most, std::abs(masses.far_position() - masses.near_position()) / envelope);
    TEST_ASSERT_DOUBLE_RELATIVE(1e-14, as_double(envelope), as_double(masses.amplitude()));
  }
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0, as_double(most));
}

TEST_HOST(what_does_not_ring_is_refused_by_name) {
  const double nan = std::nan("");
  TEST_ASSERT_TRUE(refusal_of({0.0, 632.0, 0.0}).rfind("mass: 0: ", 0) == 0);
  TEST_ASSERT_TRUE(refusal_of({1.0, -1.0, 0.0}).rfind("stiffness: -1: ", 0) == 0);
  TEST_ASSERT_TRUE(refusal_of({1.0, INFINITY, 0.0}).rfind("stiffness: inf: ", 0) == 0);
  TEST_ASSERT_TRUE(
      refusal_of({1.0, 100.0, 20.0}).rfind("damping: 20: out of range, from 0 to below the critical 20 ", 0) == 0);
  TEST_ASSERT_TRUE(refusal_of({1.0, 100.0, nan}).rfind("damping: nan: ", 0) == 0);
  TEST_ASSERT_TRUE(refusal_of({1.0, 100.0, 19.9}).empty());
  CHECK_THROWS_AS(TwoMasses({1.0, 632.0, 0.0}).advance(-1.0L), std::invalid_argument);
}
