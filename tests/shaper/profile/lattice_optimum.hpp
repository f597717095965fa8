// SPDX-License-Identifier: Apache-2.0
// The fastest way to rest by searching all of them: every sequence of whole jerks up to the limit, each for one tick,
// from every state at once. It knows nothing of shapes, switching or peaks. Each sequence it finds is a motion within
// the limits in continuous time, so an optimum may never take longer; that it switches on ticks only makes it a tick or
// two slower.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <vector>

namespace stillpoint::testing {

// With whole jerks the states at ticks have whole a, 2v and 6p.
struct LatticeState {
  int acceleration;
  int velocity_2;
  int position_6;
};

struct LatticeLimits {
  int acceleration;
  int deceleration;
  int velocity_2;
  int jerk = 1;
  int braking_jerk = 1;
};

class LatticeOptimum {
 public:
  static constexpr int kUnreached = 0xFFFF;

  LatticeOptimum(const LatticeLimits& limits, int reach_6)
      : limits_(limits),
        strongest_(limits.acceleration > limits.deceleration ? limits.acceleration : limits.deceleration),
        weakest_(limits.acceleration + limits.deceleration - strongest_),
        strongest_jerk_(limits.jerk > limits.braking_jerk ? limits.jerk : limits.braking_jerk),
        reach_6_(reach_6),
        ticks_(static_cast<size_t>(2 * strongest_ + 1) * static_cast<size_t>(2 * limits.velocity_2 + 1) *
                   static_cast<size_t>(2 * reach_6 + 1),
               kUnreached) {
    std::vector<LatticeState> layer{LatticeState{0, 0, 0}};
    ticks_[index(layer[0])] = 0;
    for (uint16_t ticks = 1; !layer.empty() && ticks < kUnreached; ++ticks) layer = before(layer, ticks);
  }

  // Ticks from the state to rest at 0, or kUnreached.
  int ticks(const LatticeState& state) const { return valid(state) ? ticks_[index(state)] : kUnreached; }

 private:
  // From which states one tick leads into the layer.
  std::vector<LatticeState> before(const std::vector<LatticeState>& layer, uint16_t ticks) {
    std::vector<LatticeState> found;
    for (const LatticeState& to : layer) {
      for (int jerk = -strongest_jerk_; jerk <= strongest_jerk_; ++jerk) {
        LatticeState from{to.acceleration - jerk, 0, 0};
        from.velocity_2 = to.velocity_2 - 2 * from.acceleration - jerk;
        from.position_6 = to.position_6 - 3 * from.velocity_2 - 3 * from.acceleration - jerk;
        if (!valid(from) || !may_pass(from, to) || std::abs(jerk) > jerk_between(from, to) ||
            ticks_[index(from)] != kUnreached)
          continue;
        ticks_[index(from)] = ticks;
        found.push_back(from);
      }
    }
    return found;
  }

  // Where the velocity is or passes zero the acceleration is under both limits.
  bool may_pass(const LatticeState& from, const LatticeState& to) const {
    const bool one_sign = (from.velocity_2 > 0 && to.velocity_2 > 0) || (from.velocity_2 < 0 && to.velocity_2 < 0);
    if (one_sign || from.velocity_2 == 0 || to.velocity_2 == 0) return true;
    return std::abs(from.acceleration) <= weakest_ && std::abs(to.acceleration) <= weakest_;
  }

  // Speeding up or slowing down throughout, unless velocity or acceleration pass zero in between: then both jerks hold.
  int jerk_between(const LatticeState& from, const LatticeState& to) const {
    const bool passes = from.acceleration * to.acceleration < 0 || from.velocity_2 * to.velocity_2 < 0;
    if (passes) return limits_.jerk + limits_.braking_jerk - strongest_jerk_;
    const bool speeds_up = (from.velocity_2 + to.velocity_2) * (from.acceleration + to.acceleration) > 0;
    return speeds_up ? limits_.jerk : limits_.braking_jerk;
  }

  bool valid(const LatticeState& s) const {
    if (std::abs(s.velocity_2) > limits_.velocity_2 || std::abs(s.position_6) > reach_6_) return false;
    if (s.velocity_2 == 0) return std::abs(s.acceleration) <= weakest_;
    const int along = s.velocity_2 > 0 ? s.acceleration : -s.acceleration;
    return along <= limits_.acceleration && -along <= limits_.deceleration;
  }

  size_t index(const LatticeState& s) const {
    const auto a = static_cast<size_t>(s.acceleration + strongest_);
    const auto v = static_cast<size_t>(s.velocity_2 + limits_.velocity_2);
    const auto p = static_cast<size_t>(s.position_6 + reach_6_);
    return (a * static_cast<size_t>(2 * limits_.velocity_2 + 1) + v) * static_cast<size_t>(2 * reach_6_ + 1) + p;
  }

  LatticeLimits limits_;
  int strongest_;
  int weakest_;
  int strongest_jerk_;
  int reach_6_;
  std::vector<uint16_t> ticks_;
};

}  // namespace stillpoint::testing
