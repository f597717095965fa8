// SPDX-License-Identifier: Apache-2.0
// The zero-vibration shaper, of which the others are made: two impulses half a damped period apart (Park 2001), and the
// stage of three taps that puts its zero exactly on the sampled pole. Constexpr, so that a shaper may lie in flash.
#pragma once

#include "shaper/base/math.hpp"
#include "shaper/shaping/mode.hpp"
#include "shaper/shaping/response.hpp"

namespace stillpoint {

struct ZvImpulses {
  Impulse impulses[2];
};

constexpr double damped_ratio(double damping_ratio) {
  return math::sqrt((1.0 - damping_ratio) * (1.0 + damping_ratio));
}

// Times in the unit whose reciprocal `frequency` has.
[[gnu::noinline]] constexpr ZvImpulses zv_impulses(double frequency, double damping_ratio) {
  const double root = damped_ratio(damping_ratio);
  const double k = math::exp(-math::kPi * damping_ratio / root);
  return {{{0.0, 1.0 / (1.0 + k)}, {0.5 / (frequency * root), k / (1.0 + k)}}};
}

// Taps at 0, delay and delay + 1 ticks.
struct ZvTaps {
  uint32_t delay;
  double gain[3];
};

// The zero condition a0 + q_k a1 + q_(k+1) a2 = 0 with q_d = p^-d = e^(zeta w d dt) e^(-j wd d dt). With theta = wd dt,
// k theta <= pi < (k+1) theta, and u = pi - k theta, v = theta - u (both in [0, theta]) its imaginary part gives
// a1 : a2 = E sin v : sin u, E = e^(zeta w dt), and its real part a0 = E^k (a1 cos u + a2 E cos v): all positive, no
// difference of near-equal numbers at any frequency. `cycles_a_tick` below 1/2, so low that k stays below 2^31.
constexpr ZvTaps zv_taps(double cycles_a_tick, double damping_ratio) {
  const double angle = 2.0 * math::kPi * cycles_a_tick;
  const double theta = angle * damped_ratio(damping_ratio);
  const double k = math::floor(math::kPi / theta);
  const double u = math::kPi - k * theta;
  const double v = theta - u;
  const double growth = math::exp(damping_ratio * angle);
  const double a1 = growth * math::sin(v);
  const double a2 = math::sin(u);
  const double a0 = math::exp(damping_ratio * angle * k) * (a1 * math::cos(u) + a2 * growth * math::cos(v));
  const double sum = a0 + a1 + a2;
  return {static_cast<uint32_t>(k), {a0 / sum, a1 / sum, a2 / sum}};
}

}  // namespace stillpoint
