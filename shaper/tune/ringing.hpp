// SPDX-License-Identifier: Apache-2.0
// How much of a record is ringing. Background; doubles.
#pragma once

#include "shaper/identify/decomposition.hpp"
#include "shaper/identify/identification.hpp"

namespace stillpoint {

struct Ringing {
  double level;    // root mean square, 0 where noise is all there is
  double at_most;  // with what noise may hide or add: three standard deviations
};

// Of the ringing within [low_hz, high_hz] in a record taken as the one that `found` is from: as many samples of the
// same rate, from the same sensor. Not of the found modes alone, since an arm that has changed rings elsewhere. Offset,
// drift and what was found beside its modes (hum, what lies outside the band) are fitted to this record and taken off.
// The mean is weighted as the strongest mode decays (its envelope once more), so that the noise behind a short decay
// does not count; the noise under it comes off with the variance that the identification left. Cost: a pass of the fit
// and a transform.
Ringing ringing_of(const Record& record, double rate_hz, double low_hz, double high_hz, const Identification& found,
                   IdentifyScratch scratch, const Meanwhile& meanwhile = {});

}  // namespace stillpoint
