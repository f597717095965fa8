// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/linear.hpp"
#include "shaper/shaping/continuation.hpp"
#include "shaper/shaping/peak.hpp"
#include "shaper/shaping/prototype.hpp"
#include "shaper/shaping/zv.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kMaxOffsets = 2;
// A zero lower than a twentieth of the mode makes a train of ten periods and more, with humps of countless tops.
constexpr double kLargestOffset = 0.95;
constexpr int kMostSteps = 40;
constexpr int kMostTries = 4;

struct Offsets {
  uint32_t humps;
  double k[kMaxOffsets];  // the outer first

  uint32_t count() const { return (humps + 1) / 2; }
  uint32_t zeros() const { return humps + 1; }
  // Of zero i, rising: its offset's number and sign; the middle one has none.
  uint32_t offset_of(uint32_t i) const { return i < zeros() - 1 - i ? i : zeros() - 1 - i; }
  double sign_of(uint32_t i) const { return 2 * i + 1 == zeros() ? 0.0 : 2 * i + 1 < zeros() ? -1.0 : 1.0; }
  double ratio_of(uint32_t i) const { return sign_of(i) == 0.0 ? 1.0 : 1.0 + sign_of(i) * k[offset_of(i)]; }
  bool in_order() const { return k[0] < kLargestOffset && (count() < 2 || k[1] < k[0]) && k[count() - 1] > 0.0; }
};

void fill(const Offsets& offsets, double damping_ratio, Prototype& out) {
  out = Prototype{};
  out.is_cascade = true;
  out.is_banded = true;
  for (uint32_t i = 0; i < offsets.zeros(); ++i) {
    out.zeros[out.zero_count++] = Zero{offsets.ratio_of(i), damping_ratio};
    const ZvImpulses zv = zv_impulses(offsets.ratio_of(i), damping_ratio);
    out.train.add(zv.impulses, 2);
  }
}

// d ln V / d ratio_i at a fixed frequency: part i depends on frequency / ratio_i only.
double after_ratio(const Prototype& at, uint32_t i, double frequency) {
  const Zero& zero = at.zeros[i];
  return -log_slope_of_part(at.train, i, frequency, zero.damping_ratio) * frequency / zero.ratio;
}

// One Newton step towards humps of `log_tolerance`; the largest miss before it comes back in `miss`.
bool step(Offsets& offsets, double damping_ratio, double log_tolerance, double& miss) {
  Prototype at;
  fill(offsets, damping_ratio, at);
  LinearSystem<kMaxOffsets> system = {};
  system.clear(offsets.count());
  miss = 0.0;
  for (uint32_t j = 0; j < offsets.count(); ++j) {
    const Peak peak = peak_between(at.train, damping_ratio, at.zeros[j].ratio, at.zeros[j + 1].ratio);
    for (uint32_t i = 0; i < offsets.zeros(); ++i) {
      if (offsets.sign_of(i) != 0.0)
        system.row[j][offsets.offset_of(i)] += offsets.sign_of(i) * after_ratio(at, i, peak.frequency);
    }
    system.right(j) = log_tolerance - peak.log_residual;
    if (math::magnitude(system.right(j)) > miss) miss = math::magnitude(system.right(j));
  }
  double change[kMaxOffsets] = {};
  if (!system.solve(change)) return false;
  double part = 1.0;
  for (int halvings = 0; halvings < 7; ++halvings) {
    Offsets next = offsets;
    for (uint32_t i = 0; i < offsets.count(); ++i) next.k[i] += part * change[i];
    part *= 0.5;
    if (!next.in_order()) continue;
    offsets = next;
    return true;
  }
  return false;
}

bool solve(Offsets& offsets, double damping_ratio, double tolerance, const Meanwhile& meanwhile) {
  constexpr double kClose = 1e-11;
  const double log_tolerance = math::log(tolerance);
  for (int i = 0; i < kMostSteps; ++i) {
    meanwhile();
    double miss = 0.0;
    if (!step(offsets, damping_ratio, log_tolerance, miss)) return false;
    if (miss < kClose) return true;
  }
  return false;
}

// Where all zeros are close together V is (pi/2)^n times the distances to them, and Chebyshev's zeros make its humps
// equal.
Offsets chebyshev_offsets(uint32_t humps, double tolerance) {
  Offsets offsets{humps, {}};
  const double n = humps + 1.0;
  const double half_width = 2.0 / math::kPi * math::exp(math::log(math::ldexp(tolerance, static_cast<int>(humps))) / n);
  for (uint32_t i = 0; i < offsets.count(); ++i) {
    offsets.k[i] = half_width * math::cos(math::kPi * (2.0 * i + 1.0) / (2.0 * n));
    if (offsets.k[i] > 0.9 - 0.3 * i) offsets.k[i] = 0.9 - 0.3 * i;
  }
  return offsets;
}

// From the least tolerance, where the start is good, up to this one. Returns the last that has a solution.
double find_along_tolerance(Offsets& offsets, double damping_ratio, double tolerance, const Meanwhile& meanwhile) {
  offsets = chebyshev_offsets(offsets.humps, kMinTolerance);
  if (!solve(offsets, damping_ratio, kMinTolerance, meanwhile)) return 0.0;
  const double reached = follow(offsets, math::log(kMinTolerance), math::log(tolerance), 0.5, 0.001,
                                [damping_ratio, meanwhile](Offsets& trial, double log_tolerance) {
                                  return solve(trial, damping_ratio, math::exp(log_tolerance), meanwhile);
                                });
  return reached == math::log(tolerance) ? tolerance : math::exp(reached) * (1.0 - 1e-3);
}

// Returns `tolerance` where it finds a solution, else a lower one that has.
double find(Offsets& offsets, double damping_ratio, double tolerance, const Meanwhile& meanwhile) {
  offsets = chebyshev_offsets(offsets.humps, tolerance);
  if (solve(offsets, damping_ratio, tolerance, meanwhile)) return tolerance;
  return find_along_tolerance(offsets, damping_ratio, tolerance, meanwhile);
}

}  // namespace

Status make_convolution(uint32_t humps, double damping_ratio, double tolerance, Prototype& out,
                        const Meanwhile& meanwhile) {
  Offsets offsets{humps, {}};
  double reached = find(offsets, damping_ratio, tolerance, meanwhile);
  if (reached < tolerance) {
    // The way up depends on where it goes, and may end early where a hump changes its top: name one that is found.
    for (int i = 0; i < kMostTries; ++i) {
      const double tried = reached;
      reached = find(offsets, damping_ratio, tried, meanwhile);
      if (reached == tried) break;
    }
    return refuse(Error::kAboveMaximum, Quantity::kTolerance, tolerance, reached);
  }
  fill(offsets, damping_ratio, out);
  return kOk;
}

}  // namespace stillpoint
