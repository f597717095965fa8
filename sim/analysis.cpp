// SPDX-License-Identifier: Apache-2.0
#include "sim/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "shaper/shaping/prototype.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

constexpr long double kPi = 3.141592653589793238462643383279502884L;

struct Pole {
  long double decay;   // zeta w
  long double damped;  // wd
};

Pole pole_of(const Mode& mode) {
  const long double w = 2.0L * kPi * static_cast<long double>(mode.frequency_hz);
  const long double zeta = static_cast<long double>(mode.damping_ratio);
  return Pole{zeta * w, w * std::sqrt((1.0L - zeta) * (1.0L + zeta))};
}

long double gain_of(const Tap& tap) { return std::ldexp(static_cast<long double>(tap.gain), -kGainFractionBits); }

std::vector<ExactImpulse> impulses_of(const ShaperDesign& design, const Stage& stage, double tick_s) {
  std::vector<ExactImpulse> impulses;
  for (uint32_t i = stage.first_tap; i < stage.first_tap + stage.tap_count; ++i) {
    const Tap& tap = design.taps[i];
    impulses.push_back({static_cast<long double>(tap.delay_ticks) * static_cast<long double>(tick_s), gain_of(tap)});
  }
  return impulses;
}

// Between `inside`, where the residual is tolerated, and `outside`, where it is not.
double edge(const ShaperDesign& design, Mode mode, double tolerance, double tick_s, double inside, double outside) {
  for (int i = 0; i < 60; ++i) {
    mode.frequency_hz = 0.5 * (inside + outside);
    const bool tolerated = residual_on_grid(design, mode, tick_s) <= static_cast<long double>(tolerance);
    (tolerated ? inside : outside) = mode.frequency_hz;
  }
  return inside;
}

}  // namespace

std::vector<ExactImpulse> continuous_impulses(const SpecifiedShaper& spec) {
  if (spec.kind == ShaperKind::kNone) return {};
  Prototype prototype;
  require(make_prototype(spec, prototype));
  std::map<long double, long double> product = {{0.0L, 1.0L}};
  for (uint32_t i = 0; i < prototype.train.part_count; ++i) {
    const Cascade::Part& part = prototype.train.parts[i];
    std::map<long double, long double> next;
    for (const auto& [time, amplitude] : product) {
      for (uint32_t k = part.first; k < part.first + part.count; ++k) {
        const Impulse& impulse = prototype.train.impulses[k];
        next[time + static_cast<long double>(impulse.time)] += amplitude * static_cast<long double>(impulse.amplitude);
      }
    }
    product = next;
  }
  std::vector<ExactImpulse> impulses;
  for (const auto& [time, amplitude] : product) {
    impulses.push_back({time / static_cast<long double>(spec.mode.frequency_hz), amplitude});
  }
  return impulses;
}

long double residual(const std::vector<ExactImpulse>& impulses, const Mode& mode) {
  if (impulses.empty()) return 1.0L;
  const Pole pole = pole_of(mode);
  const long double end = impulses.back().time_s;
  std::complex<long double> sum = 0.0L;
  for (const ExactImpulse& impulse : impulses) {
    // exp(-zeta w t_n) is taken in here: no term can overflow.
    const long double amplitude = impulse.amplitude * std::exp(pole.decay * (impulse.time_s - end));
    const long double angle = pole.damped * impulse.time_s;
    sum += std::complex<long double>(amplitude * std::cos(angle), amplitude * std::sin(angle));
  }
  return std::abs(sum);
}

long double residual_on_grid(const ShaperDesign& design, const Mode& mode, double tick_s) {
  long double product = 1.0L;
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    product *= residual(impulses_of(design, design.stages[i], tick_s), mode);
  }
  return product;
}

Band tolerated_band(const ShaperDesign& design, const Mode& mode, double tolerance, double tick_s, const Band& from) {
  const double f = mode.frequency_hz;
  const auto tolerated = [&](double frequency) {
    const Mode other{frequency, mode.damping_ratio};
    return residual_on_grid(design, other, tick_s) <= static_cast<long double>(tolerance);
  };
  if (!tolerated(f * from.low_ratio) || !tolerated(f * from.high_ratio)) return Band{1.0, 1.0};
  constexpr double kStep = 1e-3;  // of f; a hump above the tolerance spans many of these
  double low = f * from.low_ratio;
  while (low > kStep * f && tolerated(low - kStep * f)) low -= kStep * f;
  const double below = std::max(low - kStep * f, 0.0);
  low = edge(design, mode, tolerance, tick_s, low, below);
  const double nyquist = 0.5 / tick_s;
  double high = std::min(f * from.high_ratio, nyquist);
  while (high < nyquist && tolerated(std::min(high + kStep * f, nyquist))) high = std::min(high + kStep * f, nyquist);
  if (high < nyquist) high = edge(design, mode, tolerance, tick_s, high, std::min(high + kStep * f, nyquist));
  return Band{low / f, high / f};
}

Band tolerated_band(const ShaperDesign& design, const SpecifiedShaper& spec, double tick_s) {
  Band from{1.0, 1.0};
  Prototype prototype;
  if (make_prototype(spec, prototype).ok() && prototype.is_banded)
    from = {prototype.zeros[0].ratio, prototype.zeros[prototype.zero_count - 1].ratio};
  return tolerated_band(design, spec.mode, spec.tolerance, tick_s, from);
}

std::vector<ImpulseTap> multiplied_out(const ShaperDesign& design, size_t most) {
  std::map<uint32_t, long double> product = {{0, 1.0L}};
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    const Stage& stage = design.stages[i];
    std::map<uint32_t, long double> next;
    for (const auto& [delay, gain] : product) {
      for (uint32_t k = stage.first_tap; k < stage.first_tap + stage.tap_count; ++k) {
        next[delay + design.taps[k].delay_ticks] += gain * gain_of(design.taps[k]);
      }
    }
    if (next.size() > most) return {};
    product = next;
  }
  std::vector<ImpulseTap> taps;
  for (const auto& [delay, gain] : product) taps.push_back({delay, gain});
  return taps;
}

long double peak_gain(const ShaperDesign& design) {
  const std::vector<ImpulseTap> taps = multiplied_out(design, kMostTaps);
  long double sum = 0.0L;
  for (const ImpulseTap& tap : taps) sum += std::abs(tap.gain);
  if (!taps.empty()) return sum;
  sum = 1.0L;
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    const Stage& stage = design.stages[i];
    long double stage_sum = 0.0L;
    for (uint32_t k = stage.first_tap; k < stage.first_tap + stage.tap_count; ++k) {
      stage_sum += std::abs(gain_of(design.taps[k]));
    }
    sum *= stage_sum;
  }
  return sum;
}

FrequencyGain highest_gain(const ShaperDesign& design, double tick_s) {
  constexpr int kPoints = 4096;
  FrequencyGain highest{1.0, 0.0};
  for (int i = 1; i <= kPoints; ++i) {
    // An undamped vibration of the arm answers as the shaper does to a sine of its frequency.
    const double frequency = 0.5 / tick_s * i / kPoints;
    const double gain = static_cast<double>(residual_on_grid(design, {frequency, 0.0}, tick_s));
    if (gain > highest.gain * (1.0 + 1e-9)) highest = {gain, frequency};
  }
  return highest;
}

}  // namespace stillpoint::sim
