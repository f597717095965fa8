// SPDX-License-Identifier: Apache-2.0
#include "sim/plant/two_masses.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

constexpr double kTwoPi = 6.283185307179586476925286766559;

void require_positive(const char* what, double value) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw bad_argument(what, shortest(value), "not finite and above zero, a finite number above zero is accepted");
}

}  // namespace

void TwoMassParameters::validate() const {
  require_positive("mass", mass_kg);
  require_positive("stiffness", stiffness_n_per_m);
  const double critical = 2.0 * std::sqrt(stiffness_n_per_m) * std::sqrt(mass_kg);
  if (damping_n_s_per_m >= 0.0 && damping_n_s_per_m < critical) return;
  throw bad_argument("damping", shortest(damping_n_s_per_m),
                     "out of range, from 0 to below the critical " + shortest(critical) + " N s/m is accepted");
}

Mode TwoMassParameters::mode() const {
  return Mode{std::sqrt(stiffness_n_per_m / mass_kg) / kTwoPi,
              0.5 * damping_n_s_per_m / std::sqrt(stiffness_n_per_m) / std::sqrt(mass_kg)};
}

TwoMassParameters TwoMassParameters::of(const Mode& mode, double mass_kg) {
  const double w = kTwoPi * mode.frequency_hz;
  return TwoMassParameters{mass_kg, mass_kg * w * w, 2.0 * mode.damping_ratio * w * mass_kg};
}

TwoMasses::TwoMasses(const TwoMassParameters& parameters) {
  parameters.validate();
  const long double mass = static_cast<long double>(parameters.mass_kg);
  decay_ = 0.5L * static_cast<long double>(parameters.damping_n_s_per_m) / mass;
  stiffness_ = static_cast<long double>(parameters.stiffness_n_per_m) / mass;
  const long double w = std::sqrt(stiffness_);
  damped_ = std::sqrt((w - decay_) * (w + decay_));
}

void TwoMasses::step(long double step_m) {
  near_ += step_m;
  deflection_ -= step_m;
  velocity_ += 2.0L * decay_ * step_m;
}

void TwoMasses::advance(long double duration_s) {
  if (!(duration_s >= 0.0L) || !std::isfinite(duration_s))
    throw std::invalid_argument("two masses: duration below zero or not finite");
  const long double envelope = std::exp(-decay_ * duration_s);
  const long double c = std::cos(damped_ * duration_s);
  const long double s = std::sin(damped_ * duration_s) / damped_;
  const long double r = deflection_;
  const long double v = velocity_;
  deflection_ = envelope * ((c + decay_ * s) * r + s * v);
  velocity_ = envelope * ((c - decay_ * s) * v - stiffness_ * s * r);
}

long double TwoMasses::amplitude() const {
  return std::hypot(deflection_, (velocity_ + decay_ * deflection_) / damped_);
}

}  // namespace stillpoint::sim
