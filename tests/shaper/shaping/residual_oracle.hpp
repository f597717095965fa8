// SPDX-License-Identifier: Apache-2.0
// The residual vibration ratio once more, from its definition (Park 2001 (1)) and apart from the product's own
// shaper/shaping/response.cpp: in long double with libm on the host, in double on the chip.
#pragma once

#include "shaper/shaping/design.hpp"

#ifndef STILLPOINT_CHIP_TESTS
#include <cmath>
#include <complex>
#endif

namespace stillpoint::testing {

#ifndef STILLPOINT_CHIP_TESTS
using Real = long double;
inline Real magnitude(const Impulse* train, uint32_t count, Real decay, Real angle) {
  std::complex<Real> sum = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const Real time = train[i].time;
    sum += static_cast<Real>(train[i].amplitude) *
           std::polar(std::exp(decay * (time - train[count - 1].time)), angle * time);
  }
  return std::abs(sum);
}
inline Real root_of(Real x) { return std::sqrt(x); }
#else
using Real = double;
inline Real magnitude(const Impulse* train, uint32_t count, Real decay, Real angle) {
  Real c = 0.0;
  Real s = 0.0;
  for (uint32_t i = 0; i < count; ++i) {
    const Real size = train[i].amplitude * math::exp(decay * (train[i].time - train[count - 1].time));
    c += size * math::cos(angle * train[i].time);
    s += size * math::sin(angle * train[i].time);
  }
  return math::sqrt(c * c + s * s);
}
inline Real root_of(Real x) { return math::sqrt(x); }
#endif

// V of impulse trains that are convolved: the product over the trains. `frequency` in cycles a unit of the times.
inline Real residual_ratio(const Cascade& trains, Real frequency, Real damping_ratio) {
  const Real w = 2 * static_cast<Real>(3.14159265358979323846264338327950288L) * frequency;
  Real product = 1;
  for (uint32_t i = 0; i < trains.part_count; ++i) {
    const Cascade::Part& part = trains.parts[i];
    product *= magnitude(trains.impulses + part.first, part.count, damping_ratio * w,
                         w * root_of(1 - damping_ratio * damping_ratio));
  }
  return product;
}

// The gains that run, as impulses at ticks.
inline Cascade impulses_of(const ShaperDesign& design) {
  Cascade out{};
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    out.parts[out.part_count++] = Cascade::Part{design.stages[i].first_tap, design.stages[i].tap_count};
  }
  for (uint32_t i = 0; i < design.tap_count; ++i) {
    const Tap& tap = design.taps[i];
    out.impulses[out.impulse_count++] =
        Impulse{static_cast<double>(tap.delay_ticks), static_cast<double>(tap.gain) / kUnityGain};
  }
  return out;
}

struct Extreme {
  Real frequency;
  Real residual;
};

// The highest (sign 1) or lowest (sign -1) point of V strictly between two frequencies: the best of `samples`, refined
// by golden section between its neighbours.
inline Extreme extreme_between(const Cascade& trains, Real damping_ratio, Real low, Real high, Real sign,
                               int samples = 24) {
  const Real step = (high - low) / static_cast<Real>(samples + 1);
  const auto height = [&](Real frequency) { return sign * residual_ratio(trains, frequency, damping_ratio); };
  Real best = low + step;
  Real best_height = height(best);
  for (int i = 2; i <= samples; ++i) {
    const Real here = height(low + static_cast<Real>(i) * step);
    if (!(here > best_height)) continue;
    best = low + static_cast<Real>(i) * step;
    best_height = here;
  }
  constexpr Real kGolden = static_cast<Real>(0.61803398874989484820L);
  Real left = best - step;
  Real right = best + step;
  Real a = right - kGolden * (right - left);
  Real b = left + kGolden * (right - left);
  Real height_a = height(a);
  Real height_b = height(b);
  for (int i = 0; i < 32; ++i) {
    if (height_a > height_b) {
      right = b;
      b = a;
      height_b = height_a;
      a = right - kGolden * (right - left);
      height_a = height(a);
    } else {
      left = a;
      a = b;
      height_a = height_b;
      b = left + kGolden * (right - left);
      height_b = height(b);
    }
  }
  return height_a > height_b ? Extreme{a, sign * height_a} : Extreme{b, sign * height_b};
}

// Where V first passes `limit_residual` on the way from `inside`, where it is below, to `limit`; `limit` where it does
// not. Tops of lobes between the steps are looked at as well, so that none is stepped over.
inline Real edge_towards(const Cascade& trains, Real damping_ratio, Real limit_residual, Real inside, Real limit,
                         Real step) {
  const auto at = [&](Real frequency) { return residual_ratio(trains, frequency, damping_ratio); };
  const Real direction = limit > inside ? 1 : -1;
  Real before = at(inside);
  Real behind = before;
  Real outside = inside;
  for (;;) {
    if ((limit - inside) * direction <= 0) return limit;
    outside = (limit - inside) * direction < step ? limit : inside + direction * step;
    const Real here = at(outside);
    if (here > limit_residual) break;
    if (before > behind && before > here && before > limit_residual * static_cast<Real>(0.9)) {
      const Extreme lobe =
          extreme_between(trains, damping_ratio, inside - step, inside + step, static_cast<Real>(1), 2);
      if (lobe.residual > limit_residual) {
        outside = lobe.frequency;
        if ((outside - inside) * direction < 0) inside -= direction * step;
        break;
      }
    }
    behind = before;
    before = here;
    inside = outside;
  }
  for (int i = 0; i < 40; ++i) {
    const Real middle = (inside + outside) / 2;
    (at(middle) <= limit_residual ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace stillpoint::testing
