// SPDX-License-Identifier: Apache-2.0
// Which profile with which shaper is still soonest.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shaper/shaping/mode.hpp"
#include "sim/evaluation.hpp"
#include "sim/experiment.hpp"
#include "sim/spec.hpp"

namespace stillpoint::sim {

struct FastestQuestion {
  MoveTask task;            // its duration and zero_delay are not looked at
  ArmModes arm;             // what it is judged on
  std::vector<Mode> modes;  // what is designed for
  double tolerance;         // still: tip acceleration at most this part of the plain peak after the move
};

// A profile, the shapers behind it (one a mode) and how they are timed.
struct Combination {
  SpecifiedProfile profile;
  std::vector<SpecifiedShaper> shapers;
  bool zero_delay;  // the soonest that the limits on the shaped stream allow
  bool still;       // the profile is planned to leave the modes still (plan_still)
};

struct FastestCandidate {
  Combination combination;
  std::string name;
  MoveTiming timing;
  uint32_t move_ticks;                  // of the last setpoint change
  std::optional<uint32_t> still_ticks;  // nothing if it never is
  double residual_ratio;                // of the plain move's
  StreamFigures stream;
};

struct FastestAnswer {
  Recording plain;
  std::vector<FastestCandidate> candidates;  // the soonest first; those that break limits or never are still last
  Recording best;                            // of the first
  ShaperDesign design;                       // that it ran through
};

// Runs every combination that the axis takes: the profile alone and behind each shaper of the family, timed plainly and
// by the shaped stream's limits; the profile that is planned still; every other kind that the axis plans, alone and
// behind a ZV. Throws a Refusal where the axis refuses the plain move. Cost: some 35 moves on the arm.
FastestAnswer find_fastest(const FastestQuestion& question, const OnProgress& on_progress = {});

}  // namespace stillpoint::sim
