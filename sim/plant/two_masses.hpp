// SPDX-License-Identifier: Apache-2.0
// Two masses joined by a spring and a damper: the plant of Park 2001, Fig. 14.
#pragma once

#include "shaper/shaping/mode.hpp"

namespace stillpoint::sim {

struct TwoMassParameters {
  double mass_kg;            // m2, the far mass
  double stiffness_n_per_m;  // k
  double damping_n_s_per_m;  // c, between the masses

  // Throws a Refusal that names the first one that is not finite and above zero (damping: from zero to below the
  // critical 2 sqrt(k m), where nothing would ring).
  void validate() const;
  // w = sqrt(k / m), zeta = c / (2 sqrt(k m)). Of valid ones.
  Mode mode() const;
  // The parameters of a plant with this mode.
  static TwoMassParameters of(const Mode& mode, double mass_kg = 1.0);
};

// The near mass x1 is wherever it is put; the far mass follows as m x2'' = k (x1 - x2) + c (x1' - x2'). (The Arm of Li
// 2017 has its damper to the ground instead.) x1 is held, and moves by steps at any instant: zero-order hold, on a tick
// grid or off it. A step of x1 by a leaves x2 where it is and, through the damper, kicks x2' by c a / m. In between
// r = x2 - x1 decays freely, r'' + 2 zeta w r' + w^2 r = 0, which is closed form: exact but for rounding. Long double;
// each advance() costs an exp, a sin and a cos.
class TwoMasses {
 public:
  // At rest at zero. Throws as TwoMassParameters::validate().
  explicit TwoMasses(const TwoMassParameters& parameters);

  // x1 moves by `step_m` at this instant.
  void step(long double step_m);
  // x1 stands for `duration_s`. Throws std::invalid_argument unless finite and at least zero.
  void advance(long double duration_s);

  long double near_position() const { return near_; }
  long double far_position() const { return near_ + deflection_; }
  long double far_velocity() const { return velocity_; }

  // Of the free vibration from this instant on, its envelope now: |C| of r = Re(C exp((-zeta w + j wd) t)).
  long double amplitude() const;

 private:
  long double decay_;      // zeta w
  long double stiffness_;  // w^2
  long double damped_;     // wd
  long double near_ = 0.0L;
  long double deflection_ = 0.0L;  // r
  long double velocity_ = 0.0L;    // r', and x2' since x1 stands
};

}  // namespace stillpoint::sim
