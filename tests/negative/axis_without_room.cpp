// SPDX-License-Identifier: Apache-2.0
// expect: room for the shortest stage
#include "shaper/axis/axis.hpp"

#ifdef MUST_NOT_COMPILE
stillpoint::Axis<2> axis;
#else
stillpoint::Axis<4> axis;
#endif
