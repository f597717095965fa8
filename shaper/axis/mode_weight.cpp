// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/mode_weight.hpp"

namespace stillpoint {

namespace {

// A tick, exp(exponent) being one over the sampled pole.
Complex exponent_a_tick(const Mode& mode, double tick_s) {
  constexpr double kPi = 3.14159265358979323846;
  const double w = 2.0 * kPi * mode.frequency_hz * tick_s;
  return {mode.damping_ratio * w, -w * math::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio)};
}

}  // namespace

ModeWeight::ModeWeight(const Mode& mode, double tick_s)
    : exponent_(exponent_a_tick(mode, tick_s)),
      one_(math::exp(exponent_)),
      two_(one_ * one_),
      rest_(two_ * one_ / (Complex{1.0, 0.0} - one_)) {}

ModeWeight::Value ModeWeight::at(double ticks, double end) const {
  const double first = math::ceil(ticks);
  const double f = first - ticks;
  const double g = 1.0 + f;
  const double h = 2.0 + f;
  const Complex turn = math::exp((first - end) * exponent_);
  const double c0 = f * f * f / 6.0;
  const double c1 = (g * g * g - 3.0 * f * f * f) / 6.0;
  const double c2 = (h * h * h - 3.0 * g * g * g + 3.0 * f * f * f) / 6.0;
  const double s0 = f * f / -2.0;
  const double s1 = (g * g - 3.0 * f * f) / -2.0;
  const double s2 = (h * h - 3.0 * g * g + 3.0 * f * f) / -2.0;
  return Value{turn * (Complex{c0, 0.0} + c1 * one_ + c2 * two_ + rest_),
               turn * (Complex{s0, 0.0} + s1 * one_ + s2 * two_)};
}

}  // namespace stillpoint
