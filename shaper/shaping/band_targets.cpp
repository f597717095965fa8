// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/band_targets.hpp"

namespace stillpoint {

namespace {

constexpr double kHumpTolerance = 2e-4;      // of V
constexpr double kHumpTolerancePart = 4e-3;  // and of the tolerance at the most
constexpr double kEdgeTolerance = 2e-3;      // of the edge's frequency
constexpr double kLobeNear = 0.3;            // of ln V

void add_humps(const Prototype& prototype, double damping_ratio, double tolerance, BandTargets& targets) {
  const double height = kHumpTolerancePart * tolerance;
  for (uint32_t i = 0; i + 1 < prototype.zero_count; ++i) {
    const Peak peak =
        peak_between(prototype.train, damping_ratio, prototype.zeros[i].ratio, prototype.zeros[i + 1].ratio);
    const double allowed = height < kHumpTolerance ? height : kHumpTolerance;
    targets.add({PointKind::kHump, peak.frequency, peak.log_residual, allowed / math::exp(peak.log_residual)});
  }
}

void add_edge(const Prototype& prototype, double damping_ratio, double inside, double limit, BandTargets& targets) {
  constexpr double kStep = 0.02;
  constexpr double kLeast = 1e-4;
  const double above_humps = targets.log_tolerance + 1e-9;
  const double ratio = edge_towards(prototype.train, damping_ratio, above_humps, inside, limit, kStep);
  if (ratio == limit) return;
  const double slope = math::magnitude(log_residual(prototype.train, ratio, damping_ratio).slope);
  const double allowed = slope * ratio * kEdgeTolerance;
  targets.add({PointKind::kEdge, ratio, targets.log_tolerance, allowed > kLeast ? allowed : kLeast});
}

void add_lobes(const Prototype& prototype, double damping_ratio, double from, double limit, BandTargets& targets) {
  constexpr double kStep = 0.04;
  constexpr double kLeast = 5e-4;
  double slope_before = -1.0;
  const int steps = limit > from ? static_cast<int>((limit - from) / kStep) - 1 : 0;
  for (int i = 1; i <= steps; ++i) {
    const double ratio = from + i * kStep;
    const LogResidual here = log_residual(prototype.train, ratio, damping_ratio);
    if (here.value > targets.log_tolerance + kLobeNear) return;
    if (slope_before > 0.0 && here.slope < 0.0) {
      const Peak lobe = peak_near(prototype.train, damping_ratio, ratio - kStep, ratio);
      const double near = math::magnitude(lobe.log_residual - targets.log_tolerance);
      const double allowed = 0.4 * near > kLeast ? 0.4 * near : kLeast;
      if (near < kLobeNear) targets.add({PointKind::kLobe, lobe.frequency, lobe.log_residual, allowed});
    }
    slope_before = here.slope;
  }
}

}  // namespace

[[gnu::noinline]] BandTargets band_targets(const Prototype& prototype, double damping_ratio, double tolerance,
                                           double cycles_a_tick, const Meanwhile& meanwhile) {
  BandTargets targets{};
  targets.two_sided = cycles_a_tick <= kTwoSidedCyclesATick;
  targets.log_tolerance = math::log(tolerance);
  if (prototype.is_banded) add_humps(prototype, damping_ratio, tolerance, targets);
  const double nyquist = 0.5 / cycles_a_tick;
  const double limit = nyquist < kHighestEdge ? nyquist : kHighestEdge;
  const double lowest = prototype.zeros[0].ratio;
  const double highest = prototype.zeros[prototype.zero_count - 1].ratio;
  add_edge(prototype, damping_ratio, lowest, 0.0, targets);
  meanwhile();
  add_edge(prototype, damping_ratio, highest, limit, targets);
  meanwhile();
  add_lobes(prototype, damping_ratio, highest, limit, targets);
  return targets;
}

}  // namespace stillpoint
