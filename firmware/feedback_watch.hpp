// SPDX-License-Identifier: Apache-2.0
// What the feedback of a tick says against the drive.
#pragma once

#include <stdint.h>

#include "firmware/registers.hpp"
#include "shaper/base/signal.hpp"

namespace stillpoint::firmware {

// Counts beyond a soft limit that an axis which stands at it may flicker by. The position window (0070), which no key
// protects, can make it less and not more: it would else put the limits off.
constexpr uint32_t kMostLimitMargin = 100;

// Each is off at 0, the position limits where low >= high. Counts, and ticks in a row.
struct FeedbackLimits {
  uint32_t following_window;  // half its width, around the shaped demand
  uint32_t ticks;             // that the following error or the position may be outside
  uint32_t most_per_tick;     // of movement between two neighbouring feedbacks
  int32_t low;                // of the position
  int32_t high;
  uint32_t margin;  // beyond low and high
};

// Tick context, but for `set`. Zero-initialised it watches nothing.
//
// A soft limit is one that is passed outwards. Where the position is outside already when it is looked at first, or
// when the limits change, it may stay, come back, and until it is inside again be as far out as it was then. Inside
// reaches as far as the margin.
class FeedbackWatch {
 public:
  // Background. Each limit takes effect by itself, at any tick from here on.
  void set(const FeedbackLimits& limits);
  // Any context: counts that the position is beyond a limit and its margin, or 0.
  uint32_t beyond_limit(Signal position) const;

  // Of one tick with valid feedback while the drive is enabled. `change` since the feedback of the tick before;
  // `neighbours` false where that is missing. The first fault that applies, or kNone.
  FaultCode look(Signal setpoint, Signal position, Signal change, bool neighbours);

  // As if it had begun anew: for enabling, and where positions are counted anew.
  void restart();

 private:
  bool is_beyond(Signal position);

  // Background's, one word each.
  uint32_t following_window_ = 0;
  uint32_t ticks_ = 0;
  uint32_t most_per_tick_ = 0;
  uint32_t low_ = 0;
  uint32_t high_ = 0;
  uint32_t margin_ = 0;

  // Ticks in a row outside.
  uint32_t lagging_ = 0;
  uint32_t beyond_ = 0;
  uint32_t low_seen_ = 0;
  uint32_t high_seen_ = 0;
  uint32_t beyond_at_first_ = 0;  // with the margin, which it may be out by more
};

}  // namespace stillpoint::firmware
