// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/grid_fit.hpp"

#include "shaper/base/linear.hpp"

namespace stillpoint {

namespace {

constexpr size_t kMaxPoints = BandTargets::kMaxPoints;
constexpr size_t kMaxParameters = 2 * kMaxZeros;
constexpr double kAskedFor = 5.0;  // tolerances: BandPoint has a fifth of it
constexpr double kClose = 0.5;     // tolerances: good enough to stop

bool build(double cycles_a_tick, GridShaper& shaper) {
  if (!shaper.is_cascade)
    return train_on_grid(shaper.zeros, shaper.zero_count, shaper.ticks, cycles_a_tick, shaper.taps);
  shaper.taps = cascade_on_grid(shaper.zeros, shaper.zero_count, cycles_a_tick);
  return true;
}

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

// The frequency or the damping of a zero; a change of 1 is 2 %.
struct Parameter {
  uint32_t zero;
  bool is_damping;

  void change(GridShaper& shaper, double by) const {
    constexpr double kRatioUnit = 0.02;
    constexpr double kDampingUnit = 0.02;
    Zero& moved = shaper.zeros[zero];
    if (is_damping) {
      moved.damping_ratio += kDampingUnit * by;
    } else {
      moved.ratio *= 1.0 + kRatioUnit * by;
    }
  }
};

class Fit {
 public:
  Fit(const BandTargets& targets, double damping_ratio, double cycles_a_tick, GridShaper& shaper)
      : targets_(targets), damping_ratio_(damping_ratio), cycles_(cycles_a_tick), shaper_(shaper) {
    bool pinned = false;
    for (uint32_t i = 0; i < shaper.zero_count; ++i) {
      if (!pinned && shaper.zeros[i].ratio == 1.0) {
        pinned = true;
        continue;
      }
      parameters_[count_++] = Parameter{i, false};
      parameters_[count_++] = Parameter{i, true};
    }
    for (uint32_t j = 0; j < targets.count; ++j) top_[j] = cycles_ * targets.points[j].ratio;
  }

  bool can_move() const { return count_ > 0; }
  GridShaper& shaper() { return shaper_; }

  // The zeros beside the mode a little elsewhere: where the descent may find its way.
  bool start_from(const GridShaper& placed, double damping, double spread) {
    shaper_ = placed;
    for (uint32_t p = 0; p < count_; ++p) {
      const double outward = placed.zeros[parameters_[p].zero].ratio > 1.0 ? spread : -spread;
      parameters_[p].change(shaper_, parameters_[p].is_damping ? damping : outward);
    }
    return valid() && build(cycles_, shaper_);
  }

  // The largest miss, in tolerances.
  double measure() {
    double worst = 0.0;
    for (uint32_t j = 0; j < targets_.count; ++j) {
      miss_[j] = targets_.two_sided ? miss_of(j) : excess_of(j);
      if (math::abs(miss_[j]) > worst) worst = math::abs(miss_[j]);
    }
    return worst;
  }

  // The same for people, 1 being what is asked. ln V is curved, so an edge may be further off than its miss says: one
  // that is not within 1 % is.
  double reported() {
    constexpr double kOff = 1.1;
    const double miss = measure() / kAskedFor;
    for (uint32_t j = 0; j < targets_.count && miss < kOff; ++j) {
      if (targets_.points[j].kind == PointKind::kEdge && is_edge_off(targets_.points[j].ratio)) return kOff;
    }
    return miss;
  }

  // The change that removes the misses in the sense of least squares, small where there is a choice.
  bool step(double stiffness) {
    double slope[kMaxPoints][kMaxParameters] = {};
    for (uint32_t p = 0; p < count_; ++p) {
      if (!differentiate(p, slope)) return false;
    }
    LinearSystem<kMaxParameters> system;
    system.clear(count_);
    for (uint32_t p = 0; p < count_; ++p) {
      for (uint32_t j = 0; j < targets_.count; ++j) {
        for (uint32_t q = 0; q < count_; ++q) system.row[p][q] += slope[j][p] * slope[j][q];
        system.right(p) -= slope[j][p] * miss_[j];
      }
      system.row[p][p] += stiffness;
    }
    double change[kMaxParameters] = {};
    if (!system.solve(change)) return false;
    for (uint32_t p = 0; p < count_; ++p) parameters_[p].change(shaper_, change[p]);
    return valid() && build(cycles_, shaper_);
  }

 private:
  double log_residual_at(uint32_t j) const { return log_residual(shaper_.taps, top_[j], damping_ratio_).value; }

  // ln V at the point: at the top, which is looked for near where it was last, or at the edge.
  double value_of(uint32_t j) {
    const BandPoint& point = targets_.points[j];
    if (point.kind == PointKind::kEdge) return log_residual_at(j);
    if (point.kind == PointKind::kLobe) {
      const double at = cycles_ * point.ratio;
      return take_top(j, peak_near(shaper_.taps, damping_ratio_, 0.93 * at, 1.07 * at));
    }
    const double low = cycles_ * shaper_.zeros[j].ratio;
    const double high = cycles_ * shaper_.zeros[j + 1].ratio;
    return take_top(j, peak_between(shaper_.taps, damping_ratio_, low, high));
  }

  double take_top(uint32_t j, const Peak& peak) {
    top_[j] = peak.frequency;
    return peak.log_residual;
  }

  double miss_of(uint32_t j) { return (value_of(j) - targets_.points[j].log_residual) / targets_.points[j].tolerance; }

  bool is_edge_off(double ratio) const {
    const double outward = ratio < 1.0 ? -0.01 : 0.01;
    const auto tolerated = [&](double at) {
      return log_residual(shaper_.taps, cycles_ * at, damping_ratio_).value <= targets_.log_tolerance;
    };
    return !tolerated(ratio * (1.0 - outward)) || (targets_.two_sided && tolerated(ratio * (1.0 + outward)));
  }

  // What is above the tolerance, or would be with a little less; edges a little further in.
  double excess_of(uint32_t j) {
    const BandPoint& point = targets_.points[j];
    if (point.kind == PointKind::kLobe && point.log_residual > targets_.log_tolerance) return 0.0;
    if (point.kind == PointKind::kEdge) top_[j] = cycles_ * point.ratio * (point.ratio < 1.0 ? 1.004 : 0.996);
    const double over = (value_of(j) - targets_.log_tolerance) / point.tolerance;
    return over > -kClose ? over + 2.0 * kClose : 0.0;
  }

  bool valid() const {
    for (uint32_t i = 0; i < shaper_.zero_count; ++i) {
      const Zero& zero = shaper_.zeros[i];
      if (!(zero.ratio > 0.0) || !(zero.ratio * cycles_ <= kHighestCyclesATick)) return false;
      if (!(zero.damping_ratio > -0.1) || !(zero.damping_ratio < 0.5)) return false;
      const bool is_hump =
          i < targets_.count && i + 1 < shaper_.zero_count && targets_.points[i].kind == PointKind::kHump;
      if (is_hump && !(zero.ratio < shaper_.zeros[i + 1].ratio)) return false;
    }
    return true;
  }

  // Forward differences, at the tops as they stand: that a top moves as well counts only in the second order.
  bool differentiate(uint32_t p, double (&slope)[kMaxPoints][kMaxParameters]) {
    constexpr double kSmall = 1e-4;
    const GridShaper kept = shaper_;
    double before[kMaxPoints] = {};
    for (uint32_t j = 0; j < targets_.count; ++j) before[j] = log_residual_at(j);
    parameters_[p].change(shaper_, kSmall);
    const bool built = build(cycles_, shaper_);
    for (uint32_t j = 0; built && j < targets_.count; ++j) {
      const bool counts = targets_.two_sided || miss_[j] != 0.0;
      slope[j][p] = counts ? (log_residual_at(j) - before[j]) / (kSmall * targets_.points[j].tolerance) : 0.0;
    }
    shaper_ = kept;
    return built;
  }

  const BandTargets& targets_;
  double damping_ratio_;
  double cycles_;
  GridShaper& shaper_;
  uint32_t count_ = 0;
  Parameter parameters_[kMaxParameters] = {};
  double top_[kMaxPoints] = {};   // frequency of each point, cycles a tick
  double miss_[kMaxPoints] = {};  // in tolerances
};

double descend(Fit& fit) {
  constexpr double kFirstStiffness = 1.0;
  constexpr double kLeastStiffness = 1e-2;
  double miss = fit.measure();
  double stiffness = kFirstStiffness;
  for (int i = 0; i < kFitSteps && miss > kClose; ++i) {
    const GridShaper kept = fit.shaper();
    const double now = fit.step(stiffness) ? fit.measure() : miss + 1.0;
    if (now < miss) {
      miss = now;
      stiffness = 0.1 * stiffness > kLeastStiffness ? 0.1 * stiffness : kLeastStiffness;
      continue;
    }
    fit.shaper() = kept;
    static_cast<void>(fit.measure());
    stiffness *= 10.0;
  }
  return miss;
}

// A negative gain is worth nearly what is asked of the band, and three times that more if it doubles the peaks. (At a
// flat price one EI of 500 up to 100 Hz got gains of 2.3 in all to mend a lobe; now the largest of 1440 is 1.07, and 25
// of 5909 bands are missed instead of 20.)
double rated(double miss, const GridShaper& shaper) {
  const double price = miss > kClose ? miss : kClose;
  if (!shaper.taps.has_negative()) return price;
  double size = 0.0;
  for (uint32_t i = 0; i < shaper.taps.impulse_count; ++i) size += math::abs(shaper.taps.impulses[i].amplitude);
  return price + kAskedFor * (0.9 + 3.0 * (size - shaper.taps.part_count));
}

// From several starts, until one ends where it may. Returns how the best is rated.
double search(Fit& fit, const GridShaper& placed, double least) {
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
  return Fit(targets, damping_ratio, cycles_a_tick, shaper).reported();
}

double fit_band(const BandTargets& targets, double damping_ratio, double cycles_a_tick, GridShaper& shaper) {
  Fit fit(targets, damping_ratio, cycles_a_tick, shaper);
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
