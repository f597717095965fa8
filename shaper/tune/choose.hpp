// SPDX-License-Identifier: Apache-2.0
// Which shaper for the modes that were found, as sure as they are. Background; doubles.
#pragma once

#include <stdint.h>

#include "shaper/base/meanwhile.hpp"
#include "shaper/identify/identification.hpp"
#include "shaper/shaping/design.hpp"
#include "shaper/shaping/shaper_spec.hpp"

namespace stillpoint {

// What is proposed: a ZV or its relatives a mode, robust by as much as the mode is uncertain.
struct TuneProposal {
  uint32_t spec_count;  // 0: nothing
  ShaperSpec specs[kMostComponents];
  double delay_s;  // centroid
  double length_s;
  double residual;  // predicted: the worst over what is not known of any mode, weighted by its part in the ringing
};

// For each mode, strongest first, the shortest of ZV, ZVD, EI, ZVDD and ZVDDD that together with those before it leaves
// at most `tolerance` wherever f and zeta may be within two standard deviations, measured on the ticks. A mode that
// rings with less than a quarter of the tolerance behind the others' shapers gets none; nor does one that the ticks or
// the cascade cannot hold, which `residual` then tells. Frequencies and dampings are rounded to 1e-4 Hz and 1e-5, which
// the drive's registers hold. Modes as identify() reports them, damping within kMaxDampingRatio or taken as that.
// Method: V of a cascade is the product of its parts' (Park 2001 (3)), so one ZV tells which of its powers will do, and
// only that is designed. Cost: a mode a ZV, the shaper chosen (an EI too, where a ZVD nearly does) and at most five
// worst_residual.
void choose(const Identification& found, double tolerance, double tick_s, TuneProposal& proposal,
            const Meanwhile& meanwhile = {});

// The cascade of a proposal. Refuses as add_shaper does.
Status design_of(const TuneProposal& proposal, double tick_s, ShaperDesign& design, const Meanwhile& meanwhile = {});

}  // namespace stillpoint
