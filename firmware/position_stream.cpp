// SPDX-License-Identifier: Apache-2.0
#include "firmware/position_stream.hpp"

#include "shaper/base/shared.hpp"
#include "shaper/base/wide.hpp"

namespace stillpoint::firmware {
namespace {

bool near(int64_t a, int64_t b) { return a - b <= kMostStreamStep && b - a <= kMostStreamStep; }

}  // namespace

bool PositionStream::accept(const int32_t* positions, size_t count) {
  if (count > kStreamPositions - positions_.size()) return false;
  int32_t before = positions_.empty() && !running() ? positions[0] : newest_;
  for (size_t i = 0; i < count; ++i) {
    if (!near(positions[i], before)) return false;
    before = positions[i];
  }
  for (size_t i = 0; i < count; ++i) {
    if (!positions_.push(positions[i])) return false;  // cannot be: there was room, and nobody else writes
  }
  newest_ = before;
  return true;
}

bool PositionStream::first(int32_t& position) const { return positions_.peek(position); }

void PositionStream::start(int32_t position, uint32_t interval) {
  interval_ = interval;
  // 1 / (6 interval^3) to 64 bits: long division in two halves.
  const uint32_t divisor = 6 * interval * interval * interval;
  const int up = __builtin_clz(divisor);
  const uint64_t normal = divisor << up;
  constexpr uint64_t kTop = UINT64_C(1) << 63;
  reciprocal_ = ((kTop / normal) << 32) + ((kTop % normal) << 32) / normal;
  shift_ = 63 - up;
  for (int32_t& point : point_) point = position;
  at_ = 0;
  store(running_, 1);
}

void PositionStream::stop() {
  store(running_, 0);
  // The tick empties the buffer only while it runs.
  positions_.clear();
}

bool PositionStream::running() const { return load(running_) != 0; }

uint32_t PositionStream::underruns() const { return load(underruns_); }

Signal PositionStream::tick() {
  if (at_ == 0) advance();
  const Signal setpoint = interval_ == 1 ? signal_from_counts(point_[3]) : on_spline();
  if (++at_ == interval_) at_ = 0;
  return setpoint;
}

void PositionStream::advance() {
  for (int i = 0; i < 3; ++i) point_[i] = point_[i + 1];
  if (!positions_.pop(point_[3]) && point_[2] != point_[1]) store(underruns_, underruns_ + 1);
}

// Against the second point, so that a standing stream stands on it to the last bit; over a common denominator, so that
// it is exact but for the last bit.
Signal PositionStream::on_spline() const {
  const int64_t n = at_;
  const int64_t all = interval_;
  const int64_t rest = all - n;
  const int64_t third = all * all * all + 3 * n * all * all + 3 * n * n * all - 3 * n * n * n;
  const auto from_second = [&](int i) { return int64_t{point_[i]} - point_[1]; };
  const int64_t moved = rest * rest * rest * from_second(0) + third * from_second(2) + n * n * n * from_second(3);
  const auto magnitude = static_cast<uint64_t>(moved < 0 ? -moved : moved);
  const auto offset = static_cast<Signal>(shifted_right(multiply(magnitude, reciprocal_), shift_).low);
  return wrapping_sum(signal_from_counts(point_[1]), moved < 0 ? -offset : offset);
}

}  // namespace stillpoint::firmware
