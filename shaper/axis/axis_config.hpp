// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "shaper/axis/turns.hpp"
#include "shaper/base/signal.hpp"
#include "shaper/base/status.hpp"
#include "shaper/profile/limits.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/profile/stream_limiter.hpp"

namespace stillpoint {

// Units of an axis: counts and seconds.
//
// Soft limits: a command whose path, before the shaper, would lead out of [low, high] is refused before it starts; a
// jog towards one stops on it in time. From outside, what leads back is accepted. (Behind a shaper that averages the
// setpoint stays inside too.) A linear axis without them may go on past the end of the position range: it wraps.
struct AxisConfig {
  double tick_s;
  AxisLimits maximum;              // no move may ask for more
  double quick_stop_deceleration;  // counts/s^2
  double quick_stop_jerk;          // counts/s^3
  int32_t soft_low_counts = 0;     // low >= high: no soft limits
  int32_t soft_high_counts = 0;
  uint32_t modulo_counts = 0;  // of a rotary axis: a turn, at most kMaxModuloCounts; 0: a linear axis

  bool has_soft_limits() const { return soft_low_counts < soft_high_counts; }

  Status validate() const;
};

// Of a trapezoid and whatever else has none, counts/s^3.
constexpr double kNoJerkLimit = 1e300;

struct Move {
  int32_t target_counts;  // of a rotary axis: its reading there, [0, modulo_counts)
  ProfileKind kind;
  AxisLimits limits;  // counts/s^n, at most the axis's maximum; promises about what leaves the shaper
  double duration_s;  // 0: the least time. Otherwise at least that; a multiple of the tick (rounded to the nearest)
  bool zero_delay;    // the *shaped* move ends within duration_s (Li 2017); with duration_s 0: in the least time
  ProfileDetail detail = {};                // for the kinds that need it
  Approach approach = Approach::kShortest;  // of a rotary axis; a linear one ignores it

  bool jerk_limited() const { return limits_jerk(kind, detail); }
};

// How a move came to its duration. From kWithin on: so that the *shaped* move is over in time.
enum class MoveTiming : uint8_t {
  kPlain,   // the duration wanted, or the least within the limits, and the shaper's length more
  kSlowed,  // the same, slowed down for a shaper that raises peaks
  kWithin,  // the profile takes the shaper's length less, and keeps the limits by itself
  kSpedUp,  // Li 2017: the plain profile, faster than its limits by as much as the shaper takes off its peaks
  kScaled,  // the same without a wanted duration: until the shaped stream meets its most binding limit
  kRaised,  // planned for higher limits, each by its own factor; see raised_plan.hpp
};

// Words for people.
const char* text(MoveTiming timing);

// What a move that was accepted will do. In flight the ticks count from where it takes over.
struct MoveReport {
  uint32_t profile_ticks;  // until the profile stands, or is at the velocity asked for
  uint32_t total_ticks;    // until the shaped setpoint does
  double optimum_ticks;    // of the continuous optimum, unshaped
  bool zero_delay_met;     // total_ticks is no more than the unshaped move of the same duration takes
  MoveTiming timing = MoveTiming::kPlain;
  Quantity binding = Quantity::kNone;  // the limit that kept it from being shorter, where it was looked for
  // Of the shaped stream where it was run (zero delay up to kLongestSearchTicks, negative gains), else of the profile,
  // which no mean of its past exceeds. counts/s^n.
  Peaks peaks = {};
};

// Setpoints that come from outside, one a tick. See StreamLimiter.
struct StreamConfig {
  AxisLimits limits;       // counts/s^n, at most the axis's maximum
  StreamPolicy policy;     // what happens to a setpoint that would break them
  uint32_t made_up_ticks;  // in a row without a setpoint before the stream counts as standing
};

enum class AxisPhase : uint8_t { kAtRest, kMoving, kDraining, kStopping, kStreaming };

// A snapshot that belongs to one tick.
struct AxisState {
  uint32_t tick;
  AxisPhase phase;
  uint64_t track_ticks;  // since the motion in force began
  Signal demand;         // before shaping
  Signal setpoint;       // after shaping: what the drive is given
  Signal zero;           // of a rotary axis: see Turns
};

// Of the last stream, from `begin_stream` on.
struct StreamState {
  bool limiting;           // its last setpoint was not followed
  bool faulted;            // it ended for that
  uint32_t limited_ticks;  // of all streams
};

}  // namespace stillpoint
