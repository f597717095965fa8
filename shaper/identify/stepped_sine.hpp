// SPDX-License-Identifier: Apache-2.0
// From the bins of a stepped sine to modes. Background.
#pragma once

#include "shaper/identify/bin.hpp"
#include "shaper/identify/response_fit.hpp"

namespace stillpoint {

// As identify_response(). What the arm rings with by itself comes off the answers once there are modes, and they are
// looked at again, at most three times, until no mode moves by its deviation; where nothing can be found any more, what
// was found stays. `answers`: as many as the excitation has steps; left with those of the last look.
Status identify_stepped(const SteppedBins& bins, const Excitation& excitation, double tick_s,
                        const ResponseConfig& config, BinAnswer* answers, ResponseScratch& scratch,
                        Identification& result, const Meanwhile& meanwhile = {});

}  // namespace stillpoint
