// SPDX-License-Identifier: Apache-2.0
// The positive train of a given length that leaves least in a band.
#pragma once

#include <coin/Clp_C_Interface.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/optimal_train_band.hpp"

namespace stillpoint::sim {

// A linear programme in the gains a_i of the ticks 0..N and the level r: least r with sum a_i = 1 and
// Re(exp(-j phase) F(pole)) <= r for every pole of the band and every phase. Both sides are long, so both are exchanged
// (semi-infinite programming: Hettich and Kortanek, SIAM Review 35, 1993): it starts from a few ticks and poles, adds
// the poles and phases where the solution rings most and the ticks whose gain would lower r most. Each solution bounds
// the least residual from both sides by sums of its own, so a bad answer of the solver can cost rounds, not truth.
class LeastResidual {
 public:
  LeastResidual(const std::vector<BandEdge>& edges, uint32_t length);

  // Exchanges until the least residual is known to be at most `tolerance`, or above it. (Or to 1e-6 of itself.)
  void decide(double tolerance);
  // Exchanges until the least residual is known to 1e-4 of itself.
  void refine();

  double lower_bound() const { return lower_; }  // no train of this length leaves less
  double upper_bound() const { return upper_; }  // what taps() leaves
  const std::vector<ImpulseTap>& taps() const { return taps_; }

 private:
  struct Limit {
    TickPole pole;
    double phase;
  };
  struct WeightedLimit {
    Limit limit;
    double weight;
  };
  struct Free {
    void operator()(Clp_Simplex* model) const { Clp_deleteModel(model); }
  };

  void add_limits(const std::vector<Limit>& limits);
  void add_ticks(const std::vector<uint32_t>& ticks);
  bool exchange(double gap);
  double coefficient(const Limit& limit, uint32_t tick) const;
  double price(const std::vector<WeightedLimit>& weights, uint32_t tick) const;
  double level() const { return Clp_primalColumnSolution(model_.get())[0]; }
  std::vector<ImpulseTap> solution() const;
  std::vector<WeightedLimit> weights() const;
  std::vector<Limit> violated_limits();
  std::vector<uint32_t> wanted_ticks();

  std::vector<BandEdge> edges_;
  uint32_t length_;
  uint32_t stride_;                           // ticks between samples of the price
  std::unique_ptr<Clp_Simplex, Free> model_;  // column 0 is r, row 0 the sum
  std::vector<Limit> limits_;
  std::vector<uint32_t> ticks_;
  std::vector<ImpulseTap> taps_;
  double lower_ = 0.0;
  double upper_ = 1.0;
};

}  // namespace stillpoint::sim
