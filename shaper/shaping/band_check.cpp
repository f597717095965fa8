// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/band_check.hpp"

#include "shaper/shaping/peak.hpp"
#include "shaper/shaping/shaper_spec.hpp"

namespace stillpoint {

namespace {

constexpr int kDampings = 9;

class Outline {
 public:
  Outline(const Cascade& taps, double tick_s) : taps_(taps), tick_s_(tick_s) {}

  void look_at(double frequency_hz, double damping_ratio) {
    take(frequency_hz, damping_ratio, log_residual(taps_, frequency_hz * tick_s_, damping_ratio).value);
  }

  void look_along(double low_hz, double high_hz, double damping_ratio) {
    constexpr double kSamplesAWave = 32.0;
    constexpr double kFewest = 16.0;
    const double waves = (high_hz - low_hz) * tick_s_ * taps_.length();
    const uint32_t steps = static_cast<uint32_t>(math::ceil(kSamplesAWave * waves) + kFewest);
    const double step = (high_hz - low_hz) / steps;
    double rises = -1.0;
    for (uint32_t i = 0; i <= steps; ++i) {
      const double frequency = low_hz + i * step;
      const LogResidual here = log_residual(taps_, frequency * tick_s_, damping_ratio);
      take(frequency, damping_ratio, here.value);
      if (rises > 0.0 && here.slope < 0.0) {
        const Peak top = peak_near(taps_, damping_ratio, (frequency - step) * tick_s_, frequency * tick_s_);
        take(top.frequency / tick_s_, damping_ratio, top.log_residual);
      }
      rises = here.slope;
    }
  }

  WorstResidual worst() const { return {math::exp(highest_), at_.frequency_hz, at_.damping_ratio}; }

 private:
  void take(double frequency_hz, double damping_ratio, double log_value) {
    if (!(log_value > highest_)) return;
    highest_ = log_value;
    at_ = {0.0, frequency_hz, damping_ratio};
  }

  const Cascade& taps_;
  double tick_s_;
  double highest_ = -1e9;
  WorstResidual at_ = {0.0, 0.0, 0.0};
};

}  // namespace

Status ModeBand::validate(double tick_s) const {
  const double nyquist = 0.5 / tick_s;
  if (!math::is_finite(low_hz)) return refuse(Error::kNotFinite, Quantity::kFrequency, low_hz);
  if (!(low_hz > 0.0)) return refuse(Error::kNotPositive, Quantity::kFrequency, low_hz);
  if (!math::is_finite(high_hz)) return refuse(Error::kNotFinite, Quantity::kFrequency, high_hz);
  if (!(high_hz > low_hz)) return refuse(Error::kBelowMinimum, Quantity::kFrequency, high_hz, low_hz * (1.0 + 1e-6));
  if (!(high_hz < nyquist)) return refuse(Error::kAboveMaximum, Quantity::kFrequency, high_hz, nyquist * (1.0 - 1e-6));
  if (!math::is_finite(low_damping)) return refuse(Error::kNotFinite, Quantity::kDampingRatio, low_damping);
  if (!math::is_finite(high_damping)) return refuse(Error::kNotFinite, Quantity::kDampingRatio, high_damping);
  if (low_damping < 0.0) return refuse(Error::kBelowMinimum, Quantity::kDampingRatio, low_damping, 0.0);
  if (high_damping < low_damping)
    return refuse(Error::kBelowMinimum, Quantity::kDampingRatio, high_damping, low_damping);
  if (high_damping > kMaxDampingRatio)
    return refuse(Error::kAboveMaximum, Quantity::kDampingRatio, high_damping, kMaxDampingRatio);
  return kOk;
}

WorstResidual worst_residual(const Cascade& taps, const ModeBand& band, double tick_s) {
  Outline outline(taps, tick_s);
  outline.look_along(band.low_hz, band.high_hz, band.low_damping);
  if (band.high_damping > band.low_damping) {
    outline.look_along(band.low_hz, band.high_hz, band.high_damping);
    for (int i = 1; i < kDampings; ++i) {
      const double damping = band.low_damping + (band.high_damping - band.low_damping) * i / kDampings;
      outline.look_at(band.low_hz, damping);
      outline.look_at(band.high_hz, damping);
    }
  }
  return outline.worst();
}

}  // namespace stillpoint
