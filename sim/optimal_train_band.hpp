// SPDX-License-Identifier: Apache-2.0
// Where in a band a train of impulses rings most.
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "sim/optimal_train.hpp"

namespace stillpoint::sim {

// A mode by what it does in a tick.
struct TickPole {
  double decay;  // zeta w dt
  double angle;  // wd dt
};

// Part of the outline of a band in the plane of poles: a ray of one damping or an arc of one frequency. V is the
// modulus of an analytic function of the pole, F(s) = sum a_i exp(-s (t_N - t_i)), so it is largest on the outline
// (maximum principle): nothing inside needs a look.
struct BandEdge {
  double low_angle;  // w dt
  double high_angle;
  double low_damping;
  double high_damping;

  TickPole at(double part) const;  // part in [0, 1]
  double length() const;           // of the path of the poles, radians a tick
};

std::vector<BandEdge> edges_of(const ModeBand& band, double tick_s);

// F with its phase counted from the middle of the train: there a symmetric one is real.
std::complex<double> response(const std::vector<ImpulseTap>& taps, uint32_t length, const TickPole& pole);

struct ResponsePeak {
  TickPole pole;
  std::complex<double> response;
};

// The peaks of |F| along the outline that reach `least`, and the highest in any case.
std::vector<ResponsePeak> peaks(const std::vector<ImpulseTap>& taps, uint32_t length,
                                const std::vector<BandEdge>& edges, double least);

}  // namespace stillpoint::sim
