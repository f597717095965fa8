// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "shaper/base/status.hpp"

namespace stillpoint {

// A limit as the tick keeps it, in whole LSB a tick^n: rounded down, and `rounding` LSB more, which is what a stream
// within the limit may pass it by for being rounded to LSB itself. At most `most`. `lsb_per_unit` is what 1 of the
// unit of `value` is. Refuses what is not finite, not above zero, or less than an LSB, and leaves `lsb`. Background.
Status limit_in_lsb(Quantity quantity, double value, double lsb_per_unit, int64_t rounding, int64_t most, int64_t& lsb);

}  // namespace stillpoint
