// SPDX-License-Identifier: Apache-2.0
// Positions from a client, a few at a time, as one setpoint a tick.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/ring_buffer.hpp"
#include "shaper/base/signal.hpp"

namespace stillpoint::firmware {

constexpr size_t kStreamPositions = 128;
constexpr uint32_t kMostStreamInterval = 800;  // 6 * 800^3 is below 2^32
// What two positions in a row may differ by, in counts.
constexpr int64_t kMostStreamStep = INT64_C(1) << 28;

// The client's positions lie `interval` ticks apart. With an interval of one they go out as they are; otherwise they
// are the control points of a uniform cubic B-spline (de Boor, A Practical Guide to Splines, IX): velocity and
// acceleration are continuous, the jerk is at most the positions' third difference over the interval cubed, and a
// polynomial of first degree passes exactly; a curve of acceleration a is cut by a interval^2 / 6. It lags the newest
// position by two intervals. When positions run out the last one is held, which the spline comes to rest on.
//
// `accept`, `start` and `stop` are the background's, `tick` the tick's. Zero-initialised storage is valid.
class PositionStream {
 public:
  // All of them, or none: where there is no room, or one lies further than kMostStreamStep from the one before.
  bool accept(const int32_t* positions, size_t count);
  size_t buffered() const { return positions_.size(); }

  // The oldest that waits, if any: where the stream is to begin.
  bool first(int32_t& position) const;

  // From here on `tick` goes on from `position`. Not while it runs.
  void start(int32_t position, uint32_t interval);
  // Ends it, and forgets what waits; also what waits for a stream that never began.
  void stop();
  bool running() const;
  // How often positions ran out while they still changed. Only goes up.
  uint32_t underruns() const;

  // The next setpoint. Integers; no division.
  Signal tick();

 private:
  void advance();
  Signal on_spline() const;

  RingBuffer<int32_t, kStreamPositions> positions_ = {};
  int32_t newest_ = 0;  // accepted; the background's
  uint32_t interval_ = 0;
  uint64_t reciprocal_ = 0;  // 2^95 / (6 interval^3, shifted up to bit 31)
  int shift_ = 0;
  uint32_t running_ = 0;
  uint32_t underruns_ = 0;

  // The tick's.
  int32_t point_[4] = {};  // oldest first
  uint32_t at_ = 0;        // ticks into the interval
};

}  // namespace stillpoint::firmware
