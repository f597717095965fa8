// SPDX-License-Identifier: Apache-2.0
// From a record of residual vibration to modes, with how sure they are. Background.
#pragma once

#include "shaper/base/status.hpp"
#include "shaper/identify/decomposition.hpp"
#include "shaper/identify/identification.hpp"

namespace stillpoint {

struct IdentifyConfig {
  double rate_hz = 0.0;           // samples a second
  size_t most_modes = 3;          // reported, 1 to kMostComponents
  double least_amplitude = 0.02;  // of a mode, over the strongest one's (Li's threshold A_v); 0 to 1

  // No sample was at the sensor's end, and somebody looked: equal ones in a top are chance then. (Two that stand as far
  // from it on either side are equal in one record of a thousand.)
  bool ends_known = false;

  Status validate() const;
};

// Modes in `record`, whose first sample is the first of the decay: the axis already at rest. Never more than four
// components, hum and drift included. Refuses a record that the memory does not hold or that is not finite; `result`
// then stays. Scale-free: no unit, offset or rate matters but as a ratio.
// Cost: a handful of passes of DecayFit for each component and kDecays transforms; calls `meanwhile` at least once a
// pass. One that is given up finds kAborted, and what else it says means nothing; what becomes of the record
// meanwhile does not matter.
Status identify(const Record& record, const IdentifyConfig& config, IdentifyScratch scratch, Identification& result,
                const Meanwhile& meanwhile = {});

}  // namespace stillpoint
