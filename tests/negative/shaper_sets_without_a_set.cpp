// SPDX-License-Identifier: Apache-2.0
// expect: at least one set
#include "shaper/axis/shaper_sets.hpp"

#ifdef MUST_NOT_COMPILE
stillpoint::ShaperSets<0> sets;
#else
stillpoint::ShaperSets<1> sets;
#endif
