// SPDX-License-Identifier: Apache-2.0
// From the bins of a stepped sine to modes. Background.
#pragma once

#include "shaper/identify/bin.hpp"
#include "shaper/identify/response_fit.hpp"

namespace stillpoint {

// As identify_response(). What rings by itself comes off the answers by the modes that were found in them, and they are
// looked at again, at most twice, until no mode moves by its deviation; what can no longer be found then stays as it
// was. `answers`: as many as the excitation has steps; left with those of the last look.
Status identify_stepped(const SteppedBins& bins, const Excitation& excitation, double tick_s,
                        const ResponseConfig& config, BinAnswer* answers, ResponseScratch& scratch,
                        Identification& result, const Meanwhile& meanwhile = {});

}  // namespace stillpoint
