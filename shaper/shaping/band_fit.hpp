// SPDX-License-Identifier: Apache-2.0
// One descent of grid_fit.cpp: how far a shaper on the ticks misses its targets, and a step towards them.
#pragma once

#include "shaper/base/linear.hpp"
#include "shaper/shaping/grid_fit.hpp"

namespace stillpoint {

constexpr size_t kMaxFitParameters = 2 * kMaxZeros;
constexpr double kAskedFor = 5.0;  // tolerances: BandPoint has a fifth of it
constexpr double kClose = 0.5;     // tolerances: good enough to stop

// The taps of the shaper's zeros, on its ticks. False where the equations are singular.
[[nodiscard]] inline bool build(double cycles_a_tick, GridShaper& shaper) {
  if (!shaper.is_cascade)
    return train_on_grid(shaper.zeros, shaper.zero_count, shaper.ticks, cycles_a_tick, shaper.taps);
  shaper.taps = cascade_on_grid(shaper.zeros, shaper.zero_count, cycles_a_tick);
  return true;
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

class BandFit {
 public:
  BandFit(const BandTargets& targets, double damping_ratio, double cycles_a_tick, GridShaper& shaper,
          const Meanwhile& meanwhile)
      : targets_(targets),
        damping_ratio_(damping_ratio),
        cycles_(cycles_a_tick),
        shaper_(shaper),
        meanwhile_(meanwhile) {
    bool pinned = false;
    for (uint32_t i = 0; i < shaper.zero_count; ++i) {
      if (!pinned && shaper.zeros[i].ratio == 1.0) {
        pinned = true;
        continue;
      }
      parameters_[count_++] = Parameter{i, false};
      parameters_[count_++] = Parameter{i, true};
    }
    for (uint32_t j = 0; j < targets.count; ++j) at_.top[j] = cycles_ * targets.points[j].ratio;
  }

  // Where the points stand, and by how much each misses, in tolerances.
  struct Measured {
    double top[BandTargets::kMaxPoints];  // cycles a tick
    double miss[BandTargets::kMaxPoints];
  };

  bool can_move() const { return count_ > 0; }
  // One of the steps that all descents have together.
  bool spend_step() { return steps_left_-- > 0; }
  GridShaper& shaper() { return shaper_; }
  Measured& measured() { return at_; }

  // The zeros beside the mode a little elsewhere: where the descent may find its way.
  bool start_from(const GridShaper& placed, double damping, double spread) {
    shaper_ = placed;
    for (uint32_t p = 0; p < count_; ++p) {
      const double outward = placed.zeros[parameters_[p].zero].ratio > 1.0 ? spread : -spread;
      parameters_[p].change(shaper_, parameters_[p].is_damping ? damping : outward);
    }
    return valid() && build(cycles_, shaper_);
  }

  // The largest miss, in tolerances. `everywhere`: tops are looked for all over their humps; otherwise near where they
  // were, as a step of the descent may.
  double measure(bool everywhere = true) {
    double worst = 0.0;
    for (uint32_t j = 0; j < targets_.count; ++j) {
      meanwhile_();
      const double value = value_of(j, everywhere);
      at_.miss[j] = targets_.two_sided ? miss_of(j, value) : excess_of(j, value);
      if (math::magnitude(at_.miss[j]) > worst) worst = math::magnitude(at_.miss[j]);
    }
    return worst;
  }

  // The same for people, 1 being what is asked. Edges are looked for, not taken from ln V where they should be: a lobe
  // on the way may end the band before.
  double reported() {
    static_cast<void>(measure());
    double worst = 0.0;
    for (uint32_t j = 0; j < targets_.count; ++j) {
      const BandPoint& point = targets_.points[j];
      double miss = 0.0;
      if (point.kind == PointKind::kHump) miss = math::magnitude(at_.miss[j]) / kAskedFor;
      meanwhile_();
      if (point.kind == PointKind::kEdge) miss = edge_miss(point.ratio);
      if (miss > worst) worst = miss;
    }
    return worst;
  }

  // The change that removes the misses in the sense of least squares, small where there is a choice.
  [[gnu::noinline]] bool step(double stiffness) {
    double slope[BandTargets::kMaxPoints][kMaxFitParameters] = {};
    double before[BandTargets::kMaxPoints] = {};
    for (uint32_t j = 0; !shaper_.is_cascade && j < targets_.count; ++j) before[j] = log_residual_at(j);
    for (uint32_t p = 0; p < count_; ++p) {
      meanwhile_();
      if (!differentiate(p, before, slope)) return false;
    }
    LinearSystem<kMaxFitParameters> system;
    system.clear(count_);
    for (uint32_t p = 0; p < count_; ++p) {
      for (uint32_t j = 0; j < targets_.count; ++j) {
        for (uint32_t q = 0; q < count_; ++q) system.row[p][q] += slope[j][p] * slope[j][q];
        system.right(p) -= slope[j][p] * at_.miss[j];
      }
      system.row[p][p] += stiffness;
    }
    double change[kMaxFitParameters] = {};
    if (!system.solve(change)) return false;
    for (uint32_t p = 0; p < count_; ++p) parameters_[p].change(shaper_, change[p]);
    return valid() && build(cycles_, shaper_);
  }

 private:
  double log_residual_at(uint32_t j) const { return log_residual(shaper_.taps, at_.top[j], damping_ratio_).value; }

  // ln V at the point: at the top, or at the edge (above two sides: a little further in).
  double value_of(uint32_t j, bool everywhere) {
    const BandPoint& point = targets_.points[j];
    if (point.kind == PointKind::kEdge) {
      const double inward = point.ratio < 1.0 ? 1.004 : 0.996;
      at_.top[j] = cycles_ * point.ratio * (targets_.two_sided ? 1.0 : inward);
      return log_residual_at(j);
    }
    if (point.kind == PointKind::kLobe) {
      const double at = cycles_ * point.ratio;
      return take_top(j, peak_near(shaper_.taps, damping_ratio_, 0.93 * at, 1.07 * at));
    }
    const double low = cycles_ * shaper_.zeros[j].ratio;
    const double high = cycles_ * shaper_.zeros[j + 1].ratio;
    const double reach = 0.08 * (high - low);
    const double near = at_.top[j];
    if (!everywhere && near - reach > low && near + reach < high)
      return take_top(j, peak_near(shaper_.taps, damping_ratio_, near - reach, near + reach));
    return take_top(j, peak_between(shaper_.taps, damping_ratio_, low, high));
  }

  double take_top(uint32_t j, const Peak& peak) {
    at_.top[j] = peak.frequency;
    return peak.log_residual;
  }

  double miss_of(uint32_t j, double value) const {
    return (value - targets_.points[j].log_residual) / targets_.points[j].tolerance;
  }

  // How far the band's end is from where it should be, over 1 %; above two sides, how much narrower it is.
  double edge_miss(double wanted) const {
    constexpr double kAsked = 0.01;
    const bool is_low = wanted < 1.0;
    const double zero = shaper_.zeros[is_low ? 0 : shaper_.zero_count - 1].ratio;
    const double inside = zero + 0.25 * (wanted - zero);
    const double step = 0.02 < 0.125 * inside ? 0.02 : 0.125 * inside;
    const double far = kHighestEdge * cycles_;
    const double limit = is_low ? 0.0 : far < 0.5 ? far : 0.5;
    const double run = edge_towards(shaper_.taps, damping_ratio_, targets_.log_tolerance + 1e-9, cycles_ * inside,
                                    limit, cycles_ * step) /
                       (cycles_ * wanted);
    const double narrower = is_low ? run - 1.0 : 1.0 - run;
    return (targets_.two_sided ? math::magnitude(narrower) : narrower) / kAsked;
  }

  // What is above the tolerance, or would be with a little less.
  double excess_of(uint32_t j, double value) const {
    const BandPoint& point = targets_.points[j];
    if (point.kind == PointKind::kLobe && point.log_residual > targets_.log_tolerance) return 0.0;
    const double over = (value - targets_.log_tolerance) / point.tolerance;
    return over > -kClose ? over + 2.0 * kClose : 0.0;
  }

  // A zero whose damping is far from the mode's leaves the mode too much.
  bool valid() const {
    constexpr double kMostDamping = 0.2;
    for (uint32_t i = 0; i < shaper_.zero_count; ++i) {
      const Zero& zero = shaper_.zeros[i];
      if (!(zero.ratio > 0.0) || !(zero.ratio * cycles_ <= kHighestCyclesATick)) return false;
      if (!(math::magnitude(zero.damping_ratio - damping_ratio_) < kMostDamping)) return false;
      const bool is_hump =
          i < targets_.count && i + 1 < shaper_.zero_count && targets_.points[i].kind == PointKind::kHump;
      if (is_hump && !(zero.ratio < shaper_.zeros[i + 1].ratio)) return false;
    }
    return true;
  }

  // Forward differences, at the tops as they stand: that a top moves as well counts only in the second order.
  // Of a cascade only the zero's own stage changes.
  bool differentiate(uint32_t p, const double (&before)[BandTargets::kMaxPoints],
                     double (&slope)[BandTargets::kMaxPoints][kMaxFitParameters]) {
    constexpr double kSmall = 1e-4;
    const uint32_t zero = parameters_[p].zero;
    GridShaper moved = shaper_;
    parameters_[p].change(moved, kSmall);
    if (shaper_.is_cascade) {
      moved.taps = cascade_on_grid(moved.zeros + zero, 1, cycles_);
    } else if (!build(cycles_, moved)) {
      return false;
    }
    for (uint32_t j = 0; j < targets_.count; ++j) {
      if (!targets_.two_sided && at_.miss[j] == 0.0) continue;
      const double after = log_residual(moved.taps, at_.top[j], damping_ratio_).value;
      const double old = shaper_.is_cascade ? log_of_stage(zero, at_.top[j]) : before[j];
      slope[j][p] = (after - old) / (kSmall * targets_.points[j].tolerance);
    }
    return true;
  }

  double log_of_stage(uint32_t stage, double frequency) const {
    Cascade alone{};
    alone.add(shaper_.taps.impulses + shaper_.taps.parts[stage].first, shaper_.taps.parts[stage].count);
    return log_residual(alone, frequency, damping_ratio_).value;
  }

  const BandTargets& targets_;
  double damping_ratio_;
  double cycles_;
  GridShaper& shaper_;
  Meanwhile meanwhile_;
  uint32_t count_ = 0;
  Parameter parameters_[kMaxFitParameters] = {};
  Measured at_ = {};
  int steps_left_ = kFitSteps;
};

}  // namespace stillpoint
