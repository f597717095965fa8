// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/design.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr double kHighestFrequencyTicks = 0.49;  // periods a tick; half a period must last at least a tick

uint32_t stages_of(ShaperKind kind) {
  switch (kind) {
    case ShaperKind::kNone: return 0;
    case ShaperKind::kZv: return 1;
    case ShaperKind::kZvd: return 2;
  }
  return 0;
}

Status check(const Mode& mode, double tick_s) {
  const Status status = mode.validate();
  if (!status.ok()) return status;
  if (!math::is_finite(tick_s)) return refuse(Error::kNotFinite, Quantity::kTick, tick_s);
  if (!(tick_s > 0.0)) return refuse(Error::kNotPositive, Quantity::kTick, tick_s);
  if (mode.damping_ratio > kMaxDampingRatio)
    return refuse(Error::kAboveMaximum, Quantity::kDampingRatio, mode.damping_ratio, kMaxDampingRatio);
  if (mode.frequency_hz * tick_s > kHighestFrequencyTicks)
    return refuse(Error::kAboveMaximum, Quantity::kFrequency, mode.frequency_hz, kHighestFrequencyTicks / tick_s);
  const double lowest = lowest_frequency_hz(ShaperKind::kZv, mode.damping_ratio, tick_s, kMaxStageTicks);
  if (mode.frequency_hz < lowest) return refuse(Error::kBelowMinimum, Quantity::kFrequency, mode.frequency_hz, lowest);
  return kOk;
}

int32_t quantised(double gain) { return static_cast<int32_t>(math::floor(gain * kUnityGain + 0.5)); }

// The zero condition 1 a0 + q_k a1 + q_(k+1) a2 = 0 with q_d = p^-d = e^(zeta w d dt) e^(-j wd d dt). With
// theta = wd dt, k theta <= pi < (k+1) theta, and u = pi - k theta, v = theta - u (both in [0, theta]) its imaginary
// part gives a1 : a2 = E sin v : sin u, E = e^(zeta w dt), and its real part a0 = E^k (a1 cos u + a2 E cos v): all
// positive, no difference of near-equal numbers at any frequency.
void append_zv(const Mode& mode, double tick_s, ShaperDesign& design) {
  const double angle = 2.0 * math::kPi * mode.frequency_hz * tick_s;
  const double theta = angle * math::sqrt(1.0 - math::square(mode.damping_ratio));
  const double k = math::floor(math::kPi / theta);
  const double u = math::kPi - k * theta;
  const double v = theta - u;
  const double growth = math::exp(mode.damping_ratio * angle);
  const double a1 = growth * math::sin(v);
  const double a2 = math::sin(u);
  const double a0 = math::exp(mode.damping_ratio * angle * k) * (a1 * math::cos(u) + a2 * growth * math::cos(v));
  const double sum = a0 + a1 + a2;
  const int32_t gain_1 = quantised(a1 / sum);
  const int32_t gain_2 = quantised(a2 / sum);
  const uint32_t delay = static_cast<uint32_t>(k);
  design.stages[design.stage_count++] = Stage{design.tap_count, 3};
  design.taps[design.tap_count++] = Tap{0, kUnityGain - gain_1 - gain_2};
  design.taps[design.tap_count++] = Tap{delay, gain_1};
  design.taps[design.tap_count++] = Tap{delay + 1, gain_2};
}

}  // namespace

uint32_t ShaperDesign::length_ticks() const { return line_length() - stage_count; }

uint32_t ShaperDesign::line_length() const {
  uint32_t length = 0;
  for (uint32_t i = 0; i < stage_count; ++i) {
    length += taps[stages[i].first_tap + stages[i].tap_count - 1].delay_ticks + 1;
  }
  return length;
}

double ShaperDesign::delay_ticks() const {
  double sum = 0.0;
  for (uint32_t i = 0; i < tap_count; ++i) sum += static_cast<double>(taps[i].gain) * taps[i].delay_ticks;
  return sum / kUnityGain;
}

Status add_shaper(ShaperKind kind, const Mode& mode, double tick_s, ShaperDesign& design) {
  if (kind == ShaperKind::kNone) return kOk;
  const Status status = check(mode, tick_s);
  if (!status.ok()) return status;
  const uint32_t stages = stages_of(kind);
  if (design.stage_count + stages > ShaperDesign::kMaxStages || design.tap_count + 3 * stages > ShaperDesign::kMaxTaps)
    return refuse(Error::kTooManyStages, Quantity::kStages, design.stage_count + stages, ShaperDesign::kMaxStages);
  for (uint32_t i = 0; i < stages; ++i) append_zv(mode, tick_s, design);
  return kOk;
}

double lowest_frequency_hz(ShaperKind kind, double damping_ratio, double tick_s, size_t line_length) {
  const uint32_t stages = stages_of(kind);
  if (stages == 0) return 0.0;
  // A stage takes k + 2 signals, and k is at most c as long as half a damped period is below c + 1 ticks.
  const double longest = math::floor(static_cast<double>(line_length) / stages) - 2.0;
  if (longest < 1.0) return kHighestFrequencyTicks / tick_s;
  return (1.0 + 1e-9) / (2.0 * tick_s * (longest + 1.0) * math::sqrt(1.0 - math::square(damping_ratio)));
}

}  // namespace stillpoint
