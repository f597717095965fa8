// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/free_cascade.hpp"

#include "shaper/base/linear.hpp"
#include "shaper/shaping/continuation.hpp"
#include "shaper/shaping/peak.hpp"
#include "shaper/shaping/zv.hpp"

namespace stillpoint {

namespace {

constexpr double kOpen = 1e3;         // the end of a band that has none
constexpr double kHighestZero = 1e2;  // above it a stage does next to nothing

struct Zeros {
  uint32_t count;
  double at[kMaxZeros];

  bool in_order() const {
    for (uint32_t i = 1; i < count; ++i) {
      if (!(at[i] > at[i - 1])) return false;
    }
    return at[0] > 0.0 && at[count - 1] < kHighestZero;
  }
};

Cascade cascade_of(const Zeros& zeros, double damping_ratio) {
  Cascade cascade{};
  for (uint32_t i = 0; i < zeros.count; ++i) cascade.add(zv_impulses(zeros.at[i], damping_ratio).impulses, 2);
  return cascade;
}

// Where constraint j binds: the low end of the band for j = 0, else the highest residual between zeros j - 1 and j.
double binding_at(const Cascade& cascade, const Zeros& zeros, uint32_t j, double damping_ratio, double high) {
  if (j == 0) return 1.0;
  const double top = peak_between(cascade, damping_ratio, zeros.at[j - 1], zeros.at[j]).frequency;
  return top < high ? top : high;
}

bool step(Zeros& zeros, double damping_ratio, double log_tolerance, double high, double& miss) {
  const Cascade cascade = cascade_of(zeros, damping_ratio);
  LinearSystem<kMaxZeros> system = {};
  system.clear(zeros.count);
  miss = 0.0;
  for (uint32_t j = 0; j < zeros.count; ++j) {
    if (j > 0 && zeros.at[j - 1] >= high) return false;
    const double x = binding_at(cascade, zeros, j, damping_ratio, high);
    for (uint32_t i = 0; i < zeros.count; ++i) {
      system.row[j][i] = -x * log_slope_of_part(cascade, i, x, damping_ratio);  // after ln of the zero
    }
    system.right(j) = log_tolerance - log_residual(cascade, x, damping_ratio).value;
    if (math::magnitude(system.right(j)) > miss) miss = math::magnitude(system.right(j));
  }
  double change[kMaxZeros] = {};
  if (!system.solve(change)) return false;
  constexpr double kLongest = 0.3;
  double largest = 0.0;
  for (uint32_t i = 0; i < zeros.count; ++i) {
    if (math::magnitude(change[i]) > largest) largest = math::magnitude(change[i]);
  }
  const double part = largest > kLongest ? kLongest / largest : 1.0;
  for (uint32_t i = 0; i < zeros.count; ++i) zeros.at[i] *= math::exp(part * change[i]);
  return zeros.in_order();
}

bool solve(Zeros& zeros, double damping_ratio, double log_tolerance, double high) {
  constexpr int kMostSteps = 25;
  constexpr double kClose = 1e-10;
  for (int i = 0; i < kMostSteps; ++i) {
    double miss = 0.0;
    if (!step(zeros, damping_ratio, log_tolerance, high, miss)) return false;
    if (miss < kClose) return true;
  }
  return false;
}

// As in make_convolution, with the band's low end at 1.
Zeros chebyshev_zeros(uint32_t count, double tolerance) {
  Zeros zeros{count, {}};
  const double n = count;
  const double size = math::exp(math::log(math::ldexp(tolerance, static_cast<int>(count) - 1)) / n);
  double half_width = 2.0 / math::kPi * size;
  if (half_width > 0.8) half_width = 0.8;
  const double centre = 1.0 / (1.0 - half_width);
  for (uint32_t i = 0; i < count; ++i) {
    zeros.at[i] = centre * (1.0 - half_width * math::cos(math::kPi * (2.0 * i + 1.0) / (2.0 * n)));
  }
  return zeros;
}

}  // namespace

bool make_free_cascade(uint32_t count, double high, double damping_ratio, double tolerance, Prototype& out) {
  const double log_tolerance = math::log(tolerance);
  Zeros zeros = chebyshev_zeros(count, tolerance);
  if (!solve(zeros, damping_ratio, log_tolerance, kOpen)) return false;
  const double last = zeros.at[count - 1];
  const double reach = edge_towards(cascade_of(zeros, damping_ratio), damping_ratio, log_tolerance + 1e-9, last,
                                    8.0 * last, 0.02 * last);
  if (reach < high) return false;
  // The band's end comes down to where it is wanted; nothing happens until it meets the last hump.
  const double reached =
      follow(zeros, -math::log(reach), -math::log(high), 0.2, 0.01, [&](Zeros& trial, double minus_log_high) {
        return solve(trial, damping_ratio, log_tolerance, math::exp(-minus_log_high));
      });
  if (reached != -math::log(high)) return false;
  out = Prototype{};
  out.is_cascade = true;
  out.train = cascade_of(zeros, damping_ratio);
  for (uint32_t i = 0; i < count; ++i) out.zeros[out.zero_count++] = Zero{zeros.at[i], damping_ratio};
  return true;
}

}  // namespace stillpoint
