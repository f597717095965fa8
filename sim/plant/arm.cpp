// SPDX-License-Identifier: Apache-2.0
#include "sim/plant/arm.hpp"

#include <cmath>
#include <stdexcept>

namespace stillpoint::sim {
namespace {

constexpr long double kPi = 3.141592653589793238462643383279502884L;

// Shares typed as decimals (0.7 + 0.3) may sum to a rounding above one.
constexpr double kShareSlack = 1e-9;

}  // namespace

Status validate(const ArmModes& modes) {
  double sum = 0.0;
  for (const ArmMode& mode : modes) {
    const Status status = mode.mode.validate();
    if (!status.ok()) return status;
    if (!std::isfinite(mode.share)) return refuse(Error::kNotFinite, Quantity::kNone, mode.share);
    if (mode.share <= 0.0) return refuse(Error::kNotPositive, Quantity::kNone, mode.share);
    sum += mode.share;
    if (sum > 1.0 + kShareSlack) return refuse(Error::kAboveMaximum, Quantity::kNone, sum, 1.0);
  }
  return kOk;
}

Arm::Arm(const ArmModes& modes, double step_s) : modes_(modes), step_s_(step_s), rigid_share_(1.0) {
  if (!validate(modes).ok()) throw std::invalid_argument("arm: modes not valid");
  if (!(step_s > 0.0) || !std::isfinite(step_s)) throw std::invalid_argument("arm: step not above zero");
  for (const ArmMode& mode : modes) {
    const long double w = 2.0L * kPi * static_cast<long double>(mode.mode.frequency_hz);
    const long double zeta = static_cast<long double>(mode.mode.damping_ratio);
    const long double h = static_cast<long double>(step_s);
    const long double decay = zeta * w;
    const long double wd = w * std::sqrt((1.0L - zeta) * (1.0L + zeta));
    const long double envelope = std::exp(-decay * h);
    const long double c = std::cos(wd * h);
    const long double s = std::sin(wd * h) / wd;
    ModeState state{};
    state.share = mode.share;
    state.stiffness = static_cast<double>(w * w);
    state.damping = static_cast<double>(2.0L * decay);
    state.lag = static_cast<double>(2.0L * zeta / w);
    state.damped_frequency = static_cast<double>(wd);
    state.yy = static_cast<double>(envelope * (c + decay * s));
    state.yv = static_cast<double>(envelope * s);
    state.vy = static_cast<double>(-envelope * w * w * s);
    state.vv = static_cast<double>(envelope * (c - decay * s));
    states_.push_back(state);
    rigid_share_ -= mode.share;
  }
  if (rigid_share_ < kShareSlack) rigid_share_ = 0.0;
}

void Arm::reset() {
  slope_ = 0.0;
  slope_change_ = 0.0;
  for (ModeState& state : states_) {
    state.y = 0.0;
    state.v = 0.0;
  }
}

void Arm::step(double increment) {
  const double slope = increment / step_s_;
  slope_change_ = slope - slope_;
  slope_ = slope;
  for (ModeState& state : states_) {
    const double v = state.v - slope_change_;
    const double y = state.y + state.lag * slope_change_;
    state.y = state.yy * y + state.yv * v;
    state.v = state.vy * y + state.vv * v;
  }
}

double Arm::deflection() const {
  double sum = 0.0;
  for (const ModeState& state : states_) sum += state.share * (state.y - state.lag * slope_);
  return sum;
}

double Arm::velocity() const {
  double sum = slope_;
  for (const ModeState& state : states_) sum += state.share * state.v;
  return sum;
}

double Arm::acceleration() const {
  double sum = rigid_share_ * slope_change_ / step_s_;
  for (const ModeState& state : states_) {
    sum -= state.share * (state.stiffness * state.y + state.damping * state.v);
  }
  return sum;
}

Arm Arm::released(double step_s) const {
  Arm arm(modes_, step_s);
  for (size_t i = 0; i < states_.size(); ++i) {
    arm.states_[i].y = states_[i].y - states_[i].lag * slope_;
    arm.states_[i].v = states_[i].v + slope_;
  }
  return arm;
}

double Arm::acceleration_envelope() const {
  double sum = 0.0;
  for (const ModeState& state : states_) {
    const double y = state.y - state.lag * slope_;  // with the motor standing
    const double v = state.v + slope_;
    // A free vibration Re(C exp(lambda t)) has |lambda| = w, so its acceleration's amplitude is w^2 times its own.
    const double quadrature = (v + 0.5 * state.damping * y) / state.damped_frequency;
    sum += state.share * state.stiffness * std::hypot(y, quadrature);
  }
  return sum;
}

}  // namespace stillpoint::sim
