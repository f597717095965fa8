// SPDX-License-Identifier: Apache-2.0
// Made-up ringing whose truth is known, and the least that any unbiased estimate of it can err.
#pragma once

#include <cmath>
#include <vector>

#include "shaper/identify/record.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

struct TrueMode {
  double frequency_hz;  // natural
  double damping_ratio;
  double amplitude;
  double phase;
};

struct Ringing {
  std::vector<TrueMode> modes;
  double rate_hz = 1000.0;
  double duration_s = 1.0;
  double offset = 0.0;
  double drift = 0.0;  // over the record
  double noise = 0.0;  // standard deviation

  size_t count() const { return static_cast<size_t>(std::lround(duration_s * rate_hz)); }
};

// Standard normal, by Box and Muller.
inline double normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.unit()));
  return radius * std::cos(2.0 * M_PI * random.unit());
}

inline std::vector<double> clean(const Ringing& ringing) {
  std::vector<double> samples(ringing.count());
  for (size_t n = 0; n < samples.size(); ++n) {
    const double t = static_cast<double>(n) / ringing.rate_hz;
    for (const TrueMode& mode : ringing.modes) {
      const double w = 2.0 * M_PI * mode.frequency_hz;
      samples[n] += mode.amplitude * std::exp(-mode.damping_ratio * w * t) *
                    std::cos(w * std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio) * t + mode.phase);
    }
  }
  return samples;
}

// The noise that makes 10 log10(mean power of the ringing / its variance) what is asked for.
inline double noise_for(const std::vector<double>& samples, double ratio_db) {
  double power = 0.0;
  for (const double sample : samples) power += sample * sample;
  return std::sqrt(power / static_cast<double>(samples.size()) * std::pow(10.0, -ratio_db / 10.0));
}

inline std::vector<float> noisy(const Ringing& ringing, const std::vector<double>& samples, Random& random) {
  std::vector<float> record(samples.size());
  for (size_t n = 0; n < record.size(); ++n) {
    const double x = static_cast<double>(n) / static_cast<double>(record.size());
    record[n] = static_cast<float>(samples[n] + ringing.offset + ringing.drift * x + ringing.noise * normal(random));
  }
  return record;
}

inline Record record_of(const std::vector<float>& samples) { return Record{samples.data(), samples.size()}; }

struct Bound {
  double frequency_variance;
  double damping_variance;
};

// The Cramer-Rao bound of frequency and damping of each mode, with phases, amplitudes, an offset and a drift unknown
// too: the inverse of the Fisher matrix of the analytic derivatives, by Gauss-Jordan in long double.
std::vector<Bound> cramer_rao(const Ringing& ringing);

// Random modes as the task has them: 1 to 200 Hz, damping 0.002 to 0.2, 0.5 to 4 s, four periods of the slowest at
// least, apart by max(2 / T, 2 (z1 f1 + z2 f2)); amplitudes within a factor of four.
Ringing random_ringing(Random& random, size_t modes);

}  // namespace stillpoint::testing
