// SPDX-License-Identifier: Apache-2.0
#include "sim/residual_curve.hpp"

#include <algorithm>

namespace stillpoint::sim {
namespace {

// Where `score` is least in [low, high], by golden section.
double least(const ResidualCurve& score, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  double left = high - kGolden * (high - low);
  double right = low + kGolden * (high - low);
  long double at_left = score(left);
  long double at_right = score(right);
  for (int i = 0; i < 60; ++i) {
    if (at_left < at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = score(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = score(right);
    }
  }
  return 0.5 * (low + high);
}

// From frequency_hz in steps until the residual is past the tolerance, then back to where it last came from far below.
double edge_of(const ResidualCurve& curve, double frequency_hz, double tolerance, double step_hz, double limit_hz) {
  const auto allowed = static_cast<long double>(tolerance);
  double inside = frequency_hz;
  double outside = frequency_hz;
  for (long double left = 0.0L; left <= 1.02L * allowed;) {
    if (outside == limit_hz) return limit_hz;
    outside = step_hz > 0.0 ? std::min(outside + step_hz, limit_hz) : std::max(outside + step_hz, limit_hz);
    left = curve(outside);
    if (left < 0.7L * allowed) inside = outside;
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (inside + outside);
    (curve(middle) <= allowed ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace

std::vector<double> zeros_of(const ResidualCurve& curve, double low_hz, double high_hz, double step_hz) {
  constexpr long double kZero = 1e-6L;  // gains of 30 bits leave 1e-8
  std::vector<double> zeros;
  long double before = curve(low_hz);
  long double here = curve(low_hz + step_hz);
  for (int i = 1; low_hz + i * step_hz <= high_hz; ++i) {
    const double f = low_hz + i * step_hz;
    const long double next = curve(f + step_hz);
    if (here <= before && here < next) {
      const double bottom = least(curve, f - step_hz, f + step_hz);
      if (curve(bottom) < kZero && bottom <= high_hz) zeros.push_back(bottom);
    }
    before = here;
    here = next;
  }
  return zeros;
}

double hump_between(const ResidualCurve& curve, double low_hz, double high_hz) {
  constexpr int kValues = 200;
  const double step = (high_hz - low_hz) / kValues;
  double top = low_hz;
  for (int i = 1; i < kValues; ++i) {
    if (curve(low_hz + i * step) > curve(top)) top = low_hz + i * step;
  }
  const ResidualCurve upside_down = [&curve](double f) { return -curve(f); };
  return static_cast<double>(curve(least(upside_down, top - step, top + step)));
}

Band band_of(const ResidualCurve& curve, double frequency_hz, double tolerance, const Band& within) {
  const double step = 0.005 * frequency_hz;
  return Band{edge_of(curve, frequency_hz, tolerance, -step, within.low_ratio * frequency_hz) / frequency_hz,
              edge_of(curve, frequency_hz, tolerance, step, within.high_ratio * frequency_hz) / frequency_hz};
}

}  // namespace stillpoint::sim
