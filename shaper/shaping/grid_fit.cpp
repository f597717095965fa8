// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/grid_fit.hpp"

#include "shaper/shaping/band_fit.hpp"

namespace stillpoint {

namespace {

// Solves and moves impulses by a tick until the gains of each pair agree.
bool settle(double cycles_a_tick, GridShaper& shaper, bool& moved) {
  constexpr int kMostMoves = 6;
  moved = false;
  for (int i = 0; i < kMostMoves; ++i) {
    if (!build(cycles_a_tick, shaper)) return false;
    if (shaper.is_cascade || !follow_signs(shaper.taps, shaper.ticks)) return true;
    moved = true;
  }
  return build(cycles_a_tick, shaper);
}

double descend(BandFit& fit) {
  constexpr double kFirstStiffness = 1.0;
  constexpr double kLeastStiffness = 1e-2;
  double miss = fit.measure();
  double stiffness = kFirstStiffness;
  for (int i = 0; i < kFitStepsAStart && miss > kClose && fit.spend_step(); ++i) {
    const GridShaper kept = fit.shaper();
    const BandFit::Measured before = fit.measured();
    const double now = fit.step(stiffness) ? fit.measure(false) : miss + 1.0;
    if (now < miss) {
      miss = now;
      stiffness = 0.1 * stiffness > kLeastStiffness ? 0.1 * stiffness : kLeastStiffness;
      continue;
    }
    fit.shaper() = kept;
    fit.measured() = before;
    stiffness *= 10.0;
  }
  return fit.measure();
}

// A negative gain is worth nearly what is asked of the band, and three times that more if it doubles the peaks. (At a
// flat price one EI of 500 up to 100 Hz got gains of 2.3 in all to mend a lobe; now the largest of 1440 is 1.07, and 25
// of 5909 bands are missed instead of 20.)
double rated(double miss, const GridShaper& shaper) {
  const double price = miss > kClose ? miss : kClose;
  if (!shaper.taps.has_negative()) return price;
  double size = 0.0;
  for (uint32_t i = 0; i < shaper.taps.impulse_count; ++i) size += math::magnitude(shaper.taps.impulses[i].amplitude);
  return price + kAskedFor * (0.9 + 3.0 * (size - shaper.taps.part_count));
}

// From several starts, until one ends where it may. Returns how the best is rated.
double search(BandFit& fit, const GridShaper& placed, double least) {
  constexpr double kStarts[kFitStarts][2] = {{0.0, 0.0},  {1.5, 0.0}, {-1.5, 0.0}, {0.0, 1.0},
                                             {0.0, -1.0}, {1.5, 1.0}, {1.5, -1.0}};
  GridShaper best = placed;
  for (int i = 0; i < kFitStarts && least > 0.8 * kAskedFor; ++i) {
    if (!fit.start_from(placed, kStarts[i][0], kStarts[i][1])) continue;
    const double now = rated(descend(fit), fit.shaper());
    if (!(now < least)) continue;
    least = now;
    best = fit.shaper();
  }
  fit.shaper() = best;
  return least;
}

}  // namespace

bool place(const Prototype& prototype, double cycles_a_tick, GridShaper& out) {
  out = GridShaper{};
  out.is_cascade = prototype.is_cascade;
  out.zero_count = prototype.zero_count;
  for (uint32_t i = 0; i < prototype.zero_count; ++i) out.zeros[i] = prototype.zeros[i];
  if (!out.is_cascade) out.ticks = split_ticks(prototype.train, cycles_a_tick);
  bool moved = false;
  return settle(cycles_a_tick, out, moved);
}

double band_miss(const BandTargets& targets, double damping_ratio, double cycles_a_tick, GridShaper& shaper) {
  return BandFit(targets, damping_ratio, cycles_a_tick, shaper, {}).reported();
}

// Out of line: as a part of its caller it would take its stack all the time.
[[gnu::noinline]] double fit_band(const BandTargets& targets, double damping_ratio, double cycles_a_tick,
                                  GridShaper& shaper, const Meanwhile& meanwhile) {
  BandFit fit(targets, damping_ratio, cycles_a_tick, shaper, meanwhile);
  double miss = fit.measure();
  const bool is_banded = targets.count > 0 && targets.points[0].kind == PointKind::kHump;
  const double enough = is_banded && targets.two_sided ? kClose : 0.8 * kAskedFor;
  // Moved zeros may want an impulse on other ticks, and other ticks the zeros elsewhere.
  GridShaper best = shaper;
  double least = rated(miss, shaper);
  for (int i = 0; i < 3 && miss > enough && fit.can_move(); ++i) {
    const GridShaper placed = shaper;
    const double now = search(fit, placed, rated(miss, shaper));
    if (now < least) {
      least = now;
      best = shaper;
    }
    bool moved = false;
    if (!shaper.taps.has_negative() || !settle(cycles_a_tick, shaper, moved) || !moved) break;
    miss = fit.measure();
  }
  shaper = best;
  return fit.reported();
}

}  // namespace stillpoint
