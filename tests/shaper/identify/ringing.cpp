// SPDX-License-Identifier: Apache-2.0
#include "tests/shaper/identify/ringing.hpp"

#include <algorithm>
#include <utility>

namespace stillpoint::testing {

namespace {

using Matrix = std::vector<std::vector<long double>>;

// One sample's derivatives: frequency, damping, amplitude and phase of each mode, offset, drift.
std::vector<long double> derivatives(const Ringing& ringing, size_t n) {
  const long double t = static_cast<long double>(n) / ringing.rate_hz;
  std::vector<long double> all;
  for (const TrueMode& mode : ringing.modes) {
    const long double two_pi = 2.0L * std::acos(-1.0L);
    const long double zeta = mode.damping_ratio, w = two_pi * mode.frequency_hz;
    const long double root = std::sqrt(1.0L - zeta * zeta);
    const long double angle = w * root * t + mode.phase;
    const long double envelope = std::exp(-zeta * w * t);
    const long double cosine = envelope * std::cos(angle), sine = envelope * std::sin(angle);
    const long double a = mode.amplitude;
    all.push_back(a * two_pi * t * (-zeta * cosine - root * sine));
    all.push_back(a * w * t * (-cosine + zeta / root * sine));
    all.push_back(cosine);
    all.push_back(-a * sine);
  }
  all.push_back(1.0L);
  all.push_back(static_cast<long double>(n) / static_cast<long double>(ringing.count()));
  return all;
}

Matrix inverse(Matrix a) {
  const size_t size = a.size();
  // Scaled to a diagonal of ones, so that pivots can be compared.
  std::vector<long double> scale(size);
  for (size_t i = 0; i < size; ++i) scale[i] = 1.0L / std::sqrt(a[i][i]);
  Matrix b(size, std::vector<long double>(size, 0.0L));
  for (size_t i = 0; i < size; ++i) {
    for (size_t k = 0; k < size; ++k) a[i][k] *= scale[i] * scale[k];
    b[i][i] = 1.0L;
  }
  for (size_t column = 0; column < size; ++column) {
    size_t best = column;
    for (size_t i = column; i < size; ++i) best = std::fabs(a[i][column]) > std::fabs(a[best][column]) ? i : best;
    std::swap(a[best], a[column]);
    std::swap(b[best], b[column]);
    const long double pivot = a[column][column];
    for (size_t k = 0; k < size; ++k) {
      a[column][k] /= pivot;
      b[column][k] /= pivot;
    }
    for (size_t i = 0; i < size; ++i) {
      if (i == column) continue;
      const long double factor = a[i][column];
      for (size_t k = 0; k < size; ++k) {
        a[i][k] -= factor * a[column][k];
        b[i][k] -= factor * b[column][k];
      }
    }
  }
  for (size_t i = 0; i < size; ++i) {
    for (size_t k = 0; k < size; ++k) b[i][k] *= scale[i] * scale[k];
  }
  return b;
}

}  // namespace

std::vector<Bound> cramer_rao(const Ringing& ringing) {
  const size_t size = 4 * ringing.modes.size() + 2;
  Matrix fisher(size, std::vector<long double>(size, 0.0L));
  for (size_t n = 0; n < ringing.count(); ++n) {
    const std::vector<long double> row = derivatives(ringing, n);
    for (size_t i = 0; i < size; ++i) {
      for (size_t k = 0; k < size; ++k) fisher[i][k] += row[i] * row[k];
    }
  }
  const Matrix covariance = inverse(fisher);
  const long double variance = static_cast<long double>(ringing.noise) * ringing.noise;
  std::vector<Bound> bounds;
  for (size_t k = 0; k < ringing.modes.size(); ++k) {
    bounds.push_back({static_cast<double>(variance * covariance[4 * k][4 * k]),
                      static_cast<double>(variance * covariance[4 * k + 1][4 * k + 1])});
  }
  return bounds;
}

Ringing random_ringing(Random& random, size_t modes) {
  const auto log_between = [&](double low, double high) {
    return low * std::exp(random.unit() * std::log(high / low));
  };
  for (;;) {
    Ringing ringing;
    ringing.duration_s = random.between(0.5, 4.0);
    ringing.offset = random.between(-1.0, 1.0);
    ringing.drift = random.between(-0.5, 0.5);
    for (size_t k = 0; k < modes; ++k) {
      ringing.modes.push_back(
          {log_between(1.0, 200.0), log_between(0.002, 0.2), log_between(0.5, 2.0), random.between(-M_PI, M_PI)});
    }
    bool good = true;
    for (size_t k = 0; k < modes; ++k) {
      const TrueMode& a = ringing.modes[k];
      good = good && a.frequency_hz * ringing.duration_s >= 4.0;
      for (size_t i = 0; i < k; ++i) {
        const TrueMode& b = ringing.modes[i];
        const double widths = 2.0 * (a.damping_ratio * a.frequency_hz + b.damping_ratio * b.frequency_hz);
        good = good && std::fabs(a.frequency_hz - b.frequency_hz) >= std::max(2.0 / ringing.duration_s, widths);
      }
    }
    if (good) return ringing;
  }
}

}  // namespace stillpoint::testing
