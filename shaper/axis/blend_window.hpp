// SPDX-License-Identifier: Apache-2.0
// Where a move leaves room for a blend. Two shapers of different delay stand apart by the delay's worth of position,
// and going over from one to the other takes velocity, acceleration and jerk of its own. With D = new - old,
//
//   y' = (1-w) old' + w new' + w' D,  y'' = ... + 2 w' D' + w'' D,  y''' = ... + 3 w' D'' + 3 w'' D' + w''' D.
//
// The rest of the move is known, so none of this is estimated: both shapers and every blend that is tried run over it
// tick by tick, in the tick's own integers, and the differences that come out are held against the limits.
#pragma once

#include <stdint.h>

#include "shaper/axis/blend.hpp"
#include "shaper/profile/limits.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/profile/track.hpp"
#include "shaper/shaping/shaper.hpp"

namespace stillpoint {

// Times along a move: 0 is its start, n the n-th sample.
struct BlendWindow {
  uint32_t begin;  // the last tick of the old shaper alone
  uint32_t order;  // of the ramp
};

// A search looks for beginnings over half of this and runs at most this far.
constexpr uint32_t kLongestBlendSearchTicks = UINT32_C(1) << 12;
// A new shaper whose own stream has to be proved to the end of the move is not blended in earlier than this before it.
constexpr uint32_t kLongestBlendProofTicks = UINT32_C(1) << 13;

// Limits in LSB/tick^n along the move, allowance for roundings included.
struct BlendLimits {
  int64_t velocity;
  int64_t acceleration;
  int64_t deceleration;
  int64_t jerk;
  int64_t rounding;  // LSB
  bool forward;

  // `stages`: of the longer cascade. The blend rounds once more, the profile too.
  static BlendLimits make(const AxisLimits& limits, bool jerk_limited, double tick_s, uint32_t stages, bool forward);
};

// A stream's newest sample and differences, signed along the move.
struct Stream {
  Signal newest;
  int64_t velocity;
  int64_t acceleration;
  int64_t jerk;

  void next(Signal signal, bool forward);
  // Never faster backwards than `lowest`.
  bool keeps(const BlendLimits& limits, int64_t lowest) const {
    return velocity >= lowest && broken(limits) == Quantity::kNone;
  }
  // The first limit it is beyond.
  Quantity broken(const BlendLimits& limits) const;
};

// Background.
class BlendSearch {
 public:
  // `from` and `to` are scratch copies of the shapers; what their lines hold is overwritten.
  BlendSearch(const Track& track, const BlendLimits& limits, Shaper& from, Shaper& to);

  // The blend that ends first of those that begin at `first` or later, keep all limits and end before the move stands
  // by the old shaper. False if there is none in reach; `resume` is then the first beginning that was not tried,
  // UINT32_MAX if the move holds no more. `proved`: the new shaper's own stream is known to keep the limits; otherwise
  // it is run to the end of the move.
  // Cost: both shapers for at most kLongestBlendSearchTicks (kLongestBlendProofTicks unless proved) ticks and twice
  // their lengths; up to 24 ramps beside them.
  bool find(uint32_t first, bool proved, BlendWindow& window, uint32_t& resume);

 private:
  static constexpr uint32_t kLeastOrder = 1;
  static constexpr uint32_t kMostOrder = 8;  // 1024 ticks
  static constexpr uint32_t kTries = 3;      // of one order at a time

  struct Try {
    BlendRamp ramp;
    Stream stream;
    uint32_t begin;
    bool alive;
  };

  void start_at(uint32_t first);
  void advance();
  void begin_tries();
  bool step_tries(BlendWindow& window);
  bool gap_leaves_room(uint32_t order) const;

  const Track& track_;
  const BlendLimits limits_;
  Shaper& from_;
  Shaper& to_;
  static constexpr uint32_t kNeverStands = UINT32_C(1) << 31;
  uint32_t stands_;  // the old shaper's output has arrived
  Sampler sampler_ = {};
  uint32_t tick_ = 0;
  Stream old_ = {};
  Stream new_ = {};
  Try tries_[kMostOrder + 1 - kLeastOrder][kTries] = {};
};

}  // namespace stillpoint
