// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/response.hpp"

namespace stillpoint {

void Cascade::add(const Impulse* train, uint32_t count) {
  parts[part_count++] = Part{impulse_count, count};
  for (uint32_t i = 0; i < count; ++i) impulses[impulse_count++] = train[i];
}

double Cascade::length() const {
  double sum = 0.0;
  for (uint32_t i = 0; i < part_count; ++i) sum += impulses[parts[i].first + parts[i].count - 1].time;
  return sum;
}

bool Cascade::has_negative() const {
  constexpr double kNothing = 4e-10;
  for (uint32_t i = 0; i < impulse_count; ++i) {
    if (impulses[i].amplitude < -kNothing) return true;
  }
  return false;
}

[[gnu::noinline]] Complex exponent_of(double frequency, double damping_ratio) {
  const double angle = 2.0 * math::kPi * frequency;
  return {angle * damping_ratio, angle * math::sqrt((1.0 - damping_ratio) * (1.0 + damping_ratio))};
}

Complex turned(const Complex& exponent, double time, double end) {
  const double angle = exponent.im * time;
  return math::exp(exponent.re * (time - end)) * Complex{math::cos(angle), math::sin(angle)};
}

Transfer transfer(const Impulse* train, uint32_t count, double frequency, double damping_ratio) {
  const Complex unit = exponent_of(1.0, damping_ratio);
  const double end = train[count - 1].time;
  const Complex exponent = frequency * unit;
  const Complex tick = math::exp(exponent);  // from a tap to its neighbour
  Complex turn{};
  Transfer sum{};
  for (uint32_t i = 0; i < count; ++i) {
    const double before_end = train[i].time - end;
    const bool is_neighbour = i > 0 && train[i].time - train[i - 1].time == 1.0;
    turn = is_neighbour ? tick * turn : turned(exponent, train[i].time, end);
    const Complex term = train[i].amplitude * turn;
    sum.value += term;
    sum.slope += Complex{unit.re * before_end, unit.im * train[i].time} * term;
  }
  return sum;
}

LogResidual log_residual(const Cascade& cascade, double frequency, double damping_ratio) {
  constexpr double kLowest = 1e-300;
  LogResidual sum{};
  for (uint32_t i = 0; i < cascade.part_count; ++i) {
    const Cascade::Part& part = cascade.parts[i];
    const Transfer at = transfer(cascade.impulses + part.first, part.count, frequency, damping_ratio);
    const double square = square_of(at.value);
    sum.value += 0.5 * math::log(square > kLowest ? square : kLowest);
    if (square > kLowest) sum.slope += (at.value.re * at.slope.re + at.value.im * at.slope.im) / square;
  }
  return sum;
}

double log_slope_of_part(const Cascade& cascade, uint32_t part, double frequency, double damping_ratio) {
  const Cascade::Part& one = cascade.parts[part];
  const Transfer at = transfer(cascade.impulses + one.first, one.count, frequency, damping_ratio);
  return (at.value.re * at.slope.re + at.value.im * at.slope.im) / square_of(at.value);
}

double residual(const Cascade& cascade, double frequency, double damping_ratio) {
  double product = 1.0;
  for (uint32_t i = 0; i < cascade.part_count; ++i) {
    const Cascade::Part& part = cascade.parts[i];
    product *=
        math::sqrt(square_of(transfer(cascade.impulses + part.first, part.count, frequency, damping_ratio).value));
  }
  return product;
}

}  // namespace stillpoint
