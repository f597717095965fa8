// SPDX-License-Identifier: Apache-2.0
// What impulses leave of a vibration. Background; doubles.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/complex.hpp"

namespace stillpoint {

struct Impulse {
  double time;
  double amplitude;
};

constexpr size_t kMaxStages = 20;  // four modes of five zeros
constexpr size_t kMaxTaps = 64;    // three a stage, or one train

// Impulse trains, convolved. Times in any unit; frequencies are then in cycles a unit.
struct Cascade {
  struct Part {
    uint32_t first;
    uint32_t count;
  };
  uint32_t part_count;
  uint32_t impulse_count;
  Part parts[kMaxStages];
  Impulse impulses[kMaxTaps];  // times rise within a part

  // Adds a train. The caller keeps the capacities.
  void add(const Impulse* train, uint32_t count);
  // The time of the last impulse.
  double length() const;
  // An amplitude below zero by more than rounds to nothing at 2^-30.
  bool has_negative() const;
};

// lambda = 2 pi f (zeta + j sqrt(1 - zeta^2)): a mode's vibration goes as exp(-conjugate(lambda) t).
Complex exponent_of(double frequency, double damping_ratio);

// exp(lambda (time - end)) but for a turn that is the same for all: the decay counts from the end, the angle from the
// beginning.
Complex turned(const Complex& exponent, double time, double end);

// The transfer sum A_i exp(lambda (t_i - t_n)) of one train, and its derivative after the frequency. |value| is the
// residual vibration V of Park 2001 (1); no term exceeds its amplitude, whatever damping and length are.
struct Transfer {
  Complex value;
  Complex slope;
};
Transfer transfer(const Impulse* train, uint32_t count, double frequency, double damping_ratio);

// ln V of the whole cascade and its derivative after the frequency; V of a convolution is the product of its parts' V
// (Park 2001 (3)). On a zero ln V is very low (-345 a part), not infinite. Cost: one exp, sin and cos an impulse.
struct LogResidual {
  double value;
  double slope;
};
LogResidual log_residual(const Cascade& cascade, double frequency, double damping_ratio);

// The same slope of one part alone.
double log_slope_of_part(const Cascade& cascade, uint32_t part, double frequency, double damping_ratio);

double residual(const Cascade& cascade, double frequency, double damping_ratio);

}  // namespace stillpoint
