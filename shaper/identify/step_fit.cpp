// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/step_fit.hpp"

namespace stillpoint {

namespace {

constexpr double kForgotten = 1e-4;  // of a ringing's energy, after a block
constexpr double kLasting = 0.3;
constexpr double kIndependent = 1e-6;  // of a column, what others leave of it
constexpr uint32_t kLeastFreedom = 2;
constexpr Complex kOne{1.0, 0.0};

// Of exp(rate) to the n, from n = 0 to where it is `last`.
[[gnu::noinline]] Complex sum_of(const Complex& last, const Complex& rate) {
  return (last - kOne) / (math::exp(rate) - kOne);
}

}  // namespace

double BlockColumn::times(const BlockColumn& other) const {
  double sum = 0.0;
  for (uint32_t i = 0; i < kParts; ++i) sum += part[i] * other.part[i];
  return sum;
}

void BlockColumn::take_off(const BlockColumn& other, double power) {
  const double factor = times(other) / power;
  for (uint32_t i = 0; i < kParts; ++i) part[i] -= factor * other.part[i];
}

StepFit::StepFit(const BlockColumn& values) : rest_(values) {
  for (uint32_t i = 0; i < BlockColumn::kParts; ++i) {
    constant_[0].part[i] = i % 2 == 0 ? 1.0 : 0.0;
    constant_[1].part[i] = i % 2 == 0 ? 0.0 : 1.0;
  }
}

// The ringing is real, so its mirror in the frequencies comes with it.
void StepFit::take_off(const IdentifiedMode& mode, double turn, double tick_s, double ticks) {
  const double angle = 2.0 * math::kPi * mode.frequency_hz * tick_s;
  const double decay = -angle * mode.damping_ratio;
  const double damped = angle * math::sqrt(1.0 - math::square(mode.damping_ratio));
  const Complex factor = math::exp(Complex{ticks * decay, ticks * damped});
  const double lasts = square_of(factor);
  if (lasts < kForgotten) return;
  const Complex own = sum_of(factor, {decay, damped - turn});
  const Complex mirror = sum_of(conjugate(factor), {decay, -damped - turn});
  const Complex unit{0.0, 1.0 / math::sqrt(square_of(own) + square_of(mirror))};
  take_off_decay(factor, unit * own, unit * mirror, false);
  if (lasts > kLasting) take_off_decay(factor, unit * own, unit * mirror, true);
}

// d own factor^b + d* mirror factor*^b for any d; with `slope` times b.
void StepFit::take_off_decay(const Complex& factor, Complex own, Complex mirror, bool slope) {
  BlockColumn columns[2];
  for (uint32_t b = 0; b < kBlocks; ++b) {
    const double times = slope ? b : 1.0;
    columns[0].part[2 * b] = times * (own.re + mirror.re);
    columns[0].part[2 * b + 1] = times * (own.im + mirror.im);
    columns[1].part[2 * b] = times * (mirror.im - own.im);
    columns[1].part[2 * b + 1] = times * (own.re - mirror.re);
    own = factor * own;
    mirror = conjugate(factor) * mirror;
  }
  for (BlockColumn& column : columns) {
    for (uint32_t k = 0; k < decays_; ++k) column.take_off(decay_[k], power_[k]);
    const double power = column.times(column);
    if (freedom_ <= kLeastFreedom || !(power > kIndependent)) continue;
    rest_.take_off(column, power);
    constant_[0].take_off(column, power);
    constant_[1].take_off(column, power);
    power_[decays_] = power;
    decay_[decays_++] = column;
    --freedom_;
  }
}

void StepFit::report(BinAnswer& answer) const {
  const double aa = constant_[0].times(constant_[0]);
  const double ab = constant_[0].times(constant_[1]);
  const double bb = constant_[1].times(constant_[1]);
  const double a = constant_[0].times(rest_);
  const double b = constant_[1].times(rest_);
  const double determinant = aa * bb - ab * ab;
  answer.re = (bb * a - ab * b) / determinant;
  answer.im = (aa * b - ab * a) / determinant;
  const double left = math::greater(rest_.times(rest_) - answer.re * a - answer.im * b, 0.0);
  answer.spread = math::sqrt(0.5 * left * (aa + bb) / (freedom_ * determinant));
}

}  // namespace stillpoint
