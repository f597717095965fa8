// SPDX-License-Identifier: Apache-2.0
// expect: nodiscard
#include "shaper/axis/axis_core.hpp"

stillpoint::Status give_up(stillpoint::AxisCore& axis, const stillpoint::Move& move);

stillpoint::Status give_up(stillpoint::AxisCore& axis, const stillpoint::Move& move) {
#ifdef MUST_NOT_COMPILE
  axis.command(move, nullptr);
#endif
  return axis.command(move, nullptr);
}
