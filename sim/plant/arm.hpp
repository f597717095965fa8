// SPDX-License-Identifier: Apache-2.0
// A flexible arm behind a motor: the plant that rings.
#pragma once

#include <vector>

#include "shaper/base/status.hpp"
#include "shaper/shaping/mode.hpp"

namespace stillpoint::sim {

// One mode of the arm and the part of the tip's displacement that goes through it. Shares sum to at most 1; what is
// left over moves rigidly with the motor.
struct ArmMode {
  Mode mode;
  double share;
};

using ArmModes = std::vector<ArmMode>;

// Finite, each mode valid, shares above 0 with a sum of at most 1; the refusal names the first that is not.
Status validate(const ArmModes& modes);

// Each mode follows the motor u as Li 2017, equation (1), has it: x'' + 2 zeta w x' + w^2 x = w^2 u, where u moves
// linearly over a tick. While u goes at the slope r the mode's own steady lag is 2 zeta r / w; with y = x - u + 2 zeta
// r / w and v = x' - r, (y, v) decays freely and the transition over the tick is closed form. At a tick boundary x and
// x' are continuous. Exact but for rounding, and only increments of the motor enter: a travel of 2^31 counts loses
// nothing.
//
// Units: any position unit, seconds. Values are those at the end of the last tick (limits from inside it).
class Arm {
 public:
  // `modes` as accepted by validate(), step_s above 0. Throws std::invalid_argument otherwise.
  Arm(const ArmModes& modes, double step_s);

  // Motor and tip at rest.
  void reset();

  // The motor moves by `increment` over the next tick.
  void step(double increment);

  // Tip minus motor.
  double deflection() const;
  double velocity() const;
  // The rigid part accelerates in jumps at tick boundaries; it counts with its mean, slope change over a tick.
  double acceleration() const;

  double step_s() const { return step_s_; }

  // The same arm from this instant on with the motor standing, in steps of another length: the rest after a move.
  Arm released(double step_s) const;

  // Upper bound of |acceleration| from here on while the motor stands: the sum of the modes' envelopes.
  double acceleration_envelope() const;

 private:
  struct ModeState {
    double share;
    double stiffness;  // w^2
    double damping;    // 2 zeta w
    double lag;        // 2 zeta / w
    double damped_frequency;
    double yy, yv, vy, vv;  // transition of (y, v) over a step
    double y;               // with the lag of the slope of the last tick
    double v;
  };

  ArmModes modes_;
  double step_s_;
  double rigid_share_;
  double slope_ = 0.0;
  double slope_change_ = 0.0;
  std::vector<ModeState> states_;
};

}  // namespace stillpoint::sim
