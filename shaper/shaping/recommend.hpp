// SPDX-License-Identifier: Apache-2.0
// Which shaper for a mode that is known to lie in a band: the shortest that leaves no more than the tolerance anywhere
// in it. Background; doubles.
#pragma once

#include "shaper/shaping/band_check.hpp"
#include "shaper/shaping/design.hpp"
#include "shaper/shaping/prototype.hpp"

namespace stillpoint {

// What is tried, in this order: ZV, ZVD, ZVDD, ZVDDD, MZV, EI 1-3, CV 1-4, each with its mode moved up the band as far
// as the band's low end lets it (a higher mode is a shorter shaper); three impulses of free spacing; cascades of two to
// five ZV shapers with free zeros, written as ZV shapers of several modes.
constexpr uint32_t kRecommendCandidates = 17;

struct Candidate {
  uint32_t spec_count;  // joined by '+'; 0 where nothing of the kind could be made
  ShaperSpec specs[kMaxZeros];
  bool keeps_band;
  WorstResidual worst;  // of the shaper as run on the ticks
  uint32_t length_ticks;
  double delay_ticks;
};

// Tries one. Its numbers are rounded to what the drive's registers hold (1e-4 Hz, 1e-5 of damping, 1e-4 of a period,
// 0.01 %), put on the ticks, and measured there over the whole band; where that is above the tolerance, it is made
// again for a little less, at most kRecommendRounds times. A candidate that does not keep the band comes back as near
// as it came, to say why it lost. `band` valid, tolerance within kMinTolerance to kMaxTolerance. Cost: kRecommendRounds
// designs and band checks at the most, two mostly.
constexpr int kRecommendRounds = 8;
Candidate try_candidate(uint32_t index, const ModeBand& band, double tolerance, double tick_s);

// Tries all. Refuses an invalid band, tolerance or tick by name; kNotAvailable kTolerance where no candidate keeps the
// band. Of two of the same length the one with the smaller delay wins. `out` is unchanged by a refusal.
Status recommend(const ModeBand& band, double tolerance, double tick_s, Candidate& out);

// Length first, then delay; what does not keep the band last.
bool is_better(const Candidate& a, const Candidate& b);

}  // namespace stillpoint
