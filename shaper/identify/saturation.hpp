// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/identify/decay_model.hpp"

namespace stillpoint {

// Whether the sensor was at its end: two samples or more that stand still at the largest or smallest value of the
// record, and leave it faster than a smooth top that is rounded to the sensor's steps would. Background, three passes
// of comparisons.
bool is_saturated(const Record& record);

// The same where noise came on top of the flat ones: in the tops of the fitted `model` the record does not rise with
// it. The slope of the record over the model, where the model is within a tenth of the record's extreme or beyond, lies
// four standard deviations below 0.6 for one side at least. Background, four passes of the model.
bool is_flattened(const Record& record, const DecayModel& model);

}  // namespace stillpoint
