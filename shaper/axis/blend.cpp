// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/blend.hpp"

namespace stillpoint {

namespace {

// (to - from) * weight / 2^shift, the halves of the difference apart, so that either meets the weight in one 64-bit
// product. 1 <= shift < 32, weight <= 2^shift, |to - from| < 2^63.
Signal mixed(Signal from, Signal to, uint32_t weight, uint32_t shift) {
  const uint64_t gap = static_cast<uint64_t>(to) - static_cast<uint64_t>(from);
  const int64_t high = static_cast<int64_t>(static_cast<int32_t>(gap >> 32)) * static_cast<int64_t>(weight);
  const uint64_t low = (gap & UINT64_C(0xFFFFFFFF)) * weight + (UINT64_C(1) << (shift - 1));
  return static_cast<Signal>(static_cast<uint64_t>(from) + (static_cast<uint64_t>(high) << (32 - shift)) +
                             (low >> shift));
}

}  // namespace

void BlendRamp::begin(uint32_t order) {
  *this = BlendRamp{};
  order_ = order;
}

Signal BlendRamp::tick(Signal from, Signal to) {
  const uint32_t quarter = UINT32_C(1) << order_;
  const bool rising = tick_ < quarter || tick_ >= 3 * quarter;
  ++tick_;
  curvature_ += rising ? 1 : -1;
  slope_ += curvature_;
  weight_ += static_cast<uint32_t>(slope_);
  return mixed(from, to, weight_, 3 * order_ + 1);
}

}  // namespace stillpoint
