// SPDX-License-Identifier: Apache-2.0
// The experiments of Park 2001, Figs. 10, 13 and 15-17, again: what the paper says, what the continuous shaper leaves
// by calculation, and what the shaper as it runs left on the simulated plant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shaper/shaping/design.hpp"
#include "sim/analysis.hpp"
#include "sim/plant/two_masses.hpp"

namespace stillpoint::sim {

constexpr double kParkTick = 1e-3;  // seconds; the paper has no grid

// The setpoints of a unit step that goes through the fixed-point Shaper, tick by tick, as the impulses they are for a
// plant that holds them. The last tap is always one of them, whatever its gain: its time is the shaper's length.
std::vector<ExactImpulse> impulses_as_run(const ShaperDesign& design, double tick_s);

// What x1 moved by the impulses leaves on the plant: the amplitude of the free vibration at the last impulse, over that
// of an unshaped unit step at the step. So counts Park's (1): each from its own last impulse. (Undamped, any other time
// gives the same. With it, a ratio at one clock time would be exp(zeta w t_n) higher: the unshaped step has then
// decayed for t_n.) The kick through the damper is in both, and cancels. On the grid the last tap may come up to a tick
// a stage after the last impulse: with damping, V is then lower by as much.
long double residual_on_plant(const std::vector<ExactImpulse>& impulses, const TwoMassParameters& plant);

struct ParkRow {
  int figure;
  std::string quantity;
  std::string unit;
  std::optional<double> paper;  // nothing where it prints no number
  double continuous;            // by calculation, the shaper between the ticks
  double on_plant;              // measured on the two masses, the shaper as run
};

// The far mass while x1 makes a unit step through the three-hump shapers, at the ticks.
struct ParkResponse {
  int figure;
  TwoMassParameters plant;
  std::vector<double> extra_insensitive;
  std::vector<double> convolution;
};

struct ParkExperiments {
  std::vector<ParkRow> rows;
  std::vector<ParkResponse> responses;  // of Figs. 15, 16, 17
};

// All of them; the shapers are for 4 Hz and humps of 5 %. A quarter of a second on a host.
ParkExperiments run_park();

}  // namespace stillpoint::sim
