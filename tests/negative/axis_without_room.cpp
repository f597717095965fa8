// SPDX-License-Identifier: Apache-2.0
// expect: room for the shortest stage
#include "shaper/axis/axis.hpp"

#ifdef MUST_NOT_COMPILE
stillpoint::Axis<6> axis;
#else
stillpoint::Axis<7> axis;
#endif
