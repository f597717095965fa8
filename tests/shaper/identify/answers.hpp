// SPDX-License-Identifier: Apache-2.0
// What an arm answers to single frequencies: analytic in long double, and by driving the simulated arm with sines.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "shaper/identify/excitation.hpp"
#include "sim/plant/arm.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

struct AnsweringArm {
  sim::ArmModes modes;
  double tick_s = 1e-3;
  double delay_s = 1e-3;
  uint32_t power = 2;
};

inline double gaussian(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.unit()));
  return radius * std::cos(2.0 * M_PI * random.unit());
}

inline std::vector<double> logarithmic(double low_hz, double high_hz, size_t count) {
  std::vector<double> frequencies;
  for (size_t n = 0; n < count; ++n)
    frequencies.push_back(low_hz * std::pow(high_hz / low_hz, static_cast<double>(n) / static_cast<double>(count - 1)));
  return frequencies;
}

// The setpoint's samples a tick apart, joined by lines, late by the delay; the modes; the derivatives at the sensor.
inline std::complex<double> analytic(const AnsweringArm& arm, double frequency_hz) {
  using Value = std::complex<long double>;
  const long double w = 2.0L * M_PIl * static_cast<long double>(frequency_hz);
  long double rigid = 1.0L;
  Value sum{};
  for (const sim::ArmMode& mode : arm.modes) {
    const long double own = 2.0L * M_PIl * static_cast<long double>(mode.mode.frequency_hz);
    const long double zeta = static_cast<long double>(mode.mode.damping_ratio);
    sum += static_cast<long double>(mode.share) * own * own / Value{own * own - w * w, 2.0L * zeta * own * w};
    rigid -= static_cast<long double>(mode.share);
  }
  const long double half = 0.5L * w * static_cast<long double>(arm.tick_s);
  const long double joined = std::sin(half) / half * std::sin(half) / half;
  const Value late = std::exp(Value{0.0L, -w * static_cast<long double>(arm.delay_s)});
  Value all = late * joined * (sum + rigid);
  for (uint32_t i = 0; i < arm.power; ++i) all *= Value{0.0L, w};
  return {static_cast<double>(all.real()), static_cast<double>(all.imag())};
}

// The same from the simulated arm: a sine until it has settled, then least squares of 200 periods and at least 4000
// ticks. The setpoint arrives a tick late, whatever delay_s.
inline std::complex<double> driven(const AnsweringArm& arm, double frequency_hz) {
  sim::Arm plant(arm.modes, arm.tick_s);
  const double turn = 2.0 * M_PI * frequency_hz * arm.tick_s;
  double slowest = 0.0;
  for (const sim::ArmMode& mode : arm.modes)
    slowest = std::max(slowest, 1.0 / (2.0 * M_PI * mode.mode.frequency_hz * mode.mode.damping_ratio));
  const auto settled = static_cast<long>(25.0 * slowest / arm.tick_s) + 2;
  const long end = settled + std::max(4000L, static_cast<long>(200.0 * 2.0 * M_PI / turn));
  double cc = 0.0, cs = 0.0, ss = 0.0, yc = 0.0, ys = 0.0, before = 0.0;
  for (long n = 0; n < end; ++n) {
    const double late = n == 0 ? 0.0 : std::sin(turn * static_cast<double>(n - 1));
    plant.step(late - before);
    before = late;
    if (n < settled) continue;
    const double c = std::cos(turn * static_cast<double>(n)), s = std::sin(turn * static_cast<double>(n));
    const double y = arm.power == 2 ? plant.acceleration() : plant.deflection() + late;
    cc += c * c, cs += c * s, ss += s * s, yc += y * c, ys += y * s;
  }
  // y = a sin + b cos over u = sin: a + j b
  const double det = ss * cc - cs * cs;
  return {(ys * cc - yc * cs) / det, (yc * ss - ys * cs) / det};
}

// How the noise lies: as large a part of each answer, or the same at all frequencies and that part of the mean.
enum class NoiseShape { kRelative, kFlat };

inline std::vector<BinAnswer> noisy_answers(const std::vector<double>& frequencies,
                                            const std::vector<std::complex<double>>& clean, double decibels,
                                            NoiseShape shape, Random& random) {
  double mean = 0.0;
  for (const std::complex<double>& answer : clean) mean += std::log(std::abs(answer));
  mean = std::exp(mean / static_cast<double>(clean.size()));
  std::vector<BinAnswer> answers;
  for (size_t n = 0; n < clean.size(); ++n) {
    const double size = shape == NoiseShape::kRelative ? std::abs(clean[n]) : mean;
    const double spread = size * std::pow(10.0, -decibels / 20.0) / std::sqrt(2.0);
    const double re = clean[n].real() + spread * gaussian(random);
    const double im = clean[n].imag() + spread * gaussian(random);
    answers.push_back(BinAnswer{frequencies[n], re, im, spread});
  }
  return answers;
}

}  // namespace stillpoint::testing
