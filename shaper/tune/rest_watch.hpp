// SPDX-License-Identifier: Apache-2.0
// When the ringing begins: the axis stands, and its motor with it.
#pragma once

#include <stdint.h>

#include "shaper/base/shared.hpp"
#include "shaper/base/signal.hpp"

namespace stillpoint {

// Sees a motion begin and end, then waits until the encoder has kept within `tolerance` for a window of ticks, at most
// so long. quiet_start() in integers, one sample at a time: says so a window after it began to be true, so what it
// triggers looks back by that. Zero-initialised it watches nothing.
class RestWatch {
 public:
  // Background. `patience`: ticks from the end of the motion after which a motor that the arm shakes is taken as it is;
  // the window that is looked back over comes on top.
  void arm(Signal tolerance, uint32_t window, uint32_t patience) {
    store(state_, kOff);
    tolerance_ = tolerance;
    window_ = window;
    patience_ = patience;
    store(state_, kArmed);
  }
  void disarm() { store(state_, kOff); }

  // Tick: the motion is over, and what the sensors read is of the rest.
  bool is_after_motion() const { return load(state_) >= kRests; }

  // Tick. True once.
  bool tick(bool axis_rests, Signal position, bool fresh) {
    const uint32_t state = load(state_);
    if (state == kOff || state == kDone) return false;
    if (!axis_rests) {
      store(state_, kMoves);
      return false;
    }
    if (state == kArmed) return false;
    if (state == kMoves) {
      store(state_, kRests);
      rested_ = 0;
      begin_at(position);
    }
    if (fresh) follow(position);
    ++rested_;
    if (++still_ < window_ && rested_ < patience_ + window_) return false;
    store(state_, kDone);
    return true;
  }

 private:
  enum State : uint32_t { kOff, kArmed, kMoves, kRests, kDone };

  void begin_at(Signal position) {
    lowest_ = 0;
    highest_ = 0;
    from_ = position;
    still_ = 0;
  }

  void follow(Signal position) {
    const Signal moved = wrapping_difference(position, from_);
    if (moved < lowest_) lowest_ = moved;
    if (moved > highest_) highest_ = moved;
    if (highest_ - lowest_ > tolerance_) begin_at(position);
  }

  Signal tolerance_ = 0;
  uint32_t window_ = 0;
  uint32_t patience_ = 0;
  uint32_t state_ = 0;
  // The tick's own. What it moved is counted from `from_`.
  Signal from_ = 0;
  Signal lowest_ = 0;
  Signal highest_ = 0;
  uint32_t rested_ = 0;  // ticks that the axis stands
  uint32_t still_ = 0;   // ticks that the encoder has kept within the tolerance
};

}  // namespace stillpoint
