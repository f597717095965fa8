// SPDX-License-Identifier: Apache-2.0
// Least squares of a sum of damped sinusoids. Background; `meanwhile` is called every 128 samples of a pass.
#pragma once

#include "shaper/base/meanwhile.hpp"
#include "shaper/identify/decay_model.hpp"
#include "shaper/identify/triangle.hpp"

namespace stillpoint {

// How sure a component is, for residual noise of variance one a sample: multiply by the variance.
struct ComponentCovariance {
  double decay;        // variance of decay
  double angle;        // of angle
  double decay_angle;  // covariance
  double evidence;     // squared amplitude over its variance (Wald), all parameters free: chi^2 with two degrees
};

// A least-squares fit and its memory (5.3 KB).
class DecayFit {
 public:
  // Offset, drift, and the amplitudes of `model` for its decays and angles; `others`, if any, is taken off the record
  // first, unless it is given up. One pass over the record: (4 K + 3)^2 * 2 multiplications and additions a sample for
  // K components.
  void solve_linear(const Record& record, DecayModel& model, const DecayModel* others = nullptr,
                    const Meanwhile& meanwhile = {});

  // Moves decays and angles from where they are to the nearest least sum of squares. At most kMostPasses passes. False,
  // with `model` where it got to, when that was not enough or it is given up. Needs more samples than parameters
  // (4 K + 2).
  // Decays stay in [-1, angle], angles in [pi, pi (count - 1)].
  // Method: variable projection (Golub and Pereyra 1973, Kaufman 1975): the amplitudes are eliminated by the triangle,
  // the rest is Levenberg-Marquardt. The derivatives of a component span x exp(-decay x) {cos, sin}(angle x), whatever
  // its amplitudes are, so that one pass gives both.
  [[nodiscard]] bool refine(const Record& record, DecayModel& model, const DecayModel* others = nullptr,
                            const Meanwhile& meanwhile = {});

  // Of the last pass. Sum of squares of what is left, and of component k.
  [[gnu::noinline]] double residual_energy() const {
    return math::square(triangle_.row[triangle_.columns - 1][triangle_.columns - 1]);
  }
  ComponentCovariance covariance(const DecayModel& model, size_t k) const;

  static constexpr int kMostPasses = 30;

 private:
  static constexpr size_t kParameters = 2 * kMostComponents;

  // The linearised problem in decays and angles: rows of the triangle and their right-hand side.
  struct Step {
    size_t size;
    double row[kParameters][kParameters];
    double right[kParameters];

    void take(const DecayFit& fit, const DecayModel& model);
    double gain() const;  // how far the sum of squares would fall
    void solve(double damping, double* change) const;
  };

  void pass(const Record& record, const DecayModel& model, const DecayModel* others, const Meanwhile& meanwhile);
  void take_amplitudes(DecayModel& model) const;
  double fitted_energy() const;  // the sum of squares with the present decays and angles

  Triangle<4 * kMostComponents + 3, 16> triangle_;
};

}  // namespace stillpoint
