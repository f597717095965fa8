// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/nearest_train.hpp"

#include "shaper/base/linear.hpp"

namespace stillpoint {

namespace {

// Ticks that a train of split impulses uses, rising, each with its linear share of the amplitudes.
struct LinearSplit {
  uint32_t count;
  Impulse taps[kMaxTaps];

  bool add(uint32_t tick, double share) {
    for (uint32_t i = 0; i < count; ++i) {
      if (taps[i].time != static_cast<double>(tick)) continue;
      taps[i].amplitude += share;
      return true;
    }
    if (count == kMaxTaps) return false;
    uint32_t at = count++;
    for (; at > 0 && taps[at - 1].time > static_cast<double>(tick); --at) taps[at] = taps[at - 1];
    taps[at] = Impulse{static_cast<double>(tick), share};
    return true;
  }
  uint32_t first_free() const {
    uint32_t tick = 0;
    while (tick < count && taps[tick].time == static_cast<double>(tick)) ++tick;
    return tick;
  }
};

bool split_linearly(const Cascade& train, double cycles_a_tick, LinearSplit& split) {
  constexpr double kOnTick = 1e-7;
  split.count = 0;
  for (uint32_t i = 0; i < train.impulse_count; ++i) {
    const Impulse& impulse = train.impulses[i];
    const double time = impulse.time / cycles_a_tick;
    const double whole = math::floor(time + kOnTick);
    const double fraction = time - whole > kOnTick ? time - whole : 0.0;
    const uint32_t tick = static_cast<uint32_t>(whole);
    if (!split.add(tick, impulse.amplitude * (1.0 - fraction))) return false;
    if (fraction > 0.0 && !split.add(tick + 1, impulse.amplitude * fraction)) return false;
  }
  // A stage has an odd number of taps, and three of them for the sum and a zero.
  while (split.count < 3 || split.count % 2 == 0) {
    if (!split.add(split.first_free(), 0.0)) return false;
  }
  return true;
}

// Sum, and real and imaginary part of the transfer at the mode: what the gains must give.
constexpr size_t kConditions = 3;
struct Conditions {
  double row[kConditions][kMaxTaps];
  double missing[kConditions];  // of the linear split
};

Conditions conditions_of(const Cascade& train, double damping_ratio, double cycles_a_tick, const LinearSplit& split) {
  const double last = split.taps[split.count - 1].time;
  const double end = train.impulses[train.impulse_count - 1].time / cycles_a_tick;
  const Complex exponent = exponent_of(cycles_a_tick, damping_ratio);
  Complex wanted = transfer(train.impulses, train.impulse_count, 1.0, damping_ratio).value;
  if (square_of(wanted) < math::square(kZeroByDesign)) wanted = Complex{};
  wanted = math::exp(exponent.re * (end - last)) * wanted;
  Conditions conditions = {{}, {1.0, wanted.re, wanted.im}};
  for (uint32_t i = 0; i < split.count; ++i) {
    const Complex q = turned(exponent, split.taps[i].time, last);
    const double column[kConditions] = {1.0, q.re, q.im};
    for (size_t k = 0; k < kConditions; ++k) {
      conditions.row[k][i] = column[k];
      conditions.missing[k] -= column[k] * split.taps[i].amplitude;
    }
  }
  return conditions;
}

bool are_met(const Conditions& conditions) {
  constexpr double kMet = 2e-10;  // less than gains resolve
  for (size_t k = 0; k < kConditions; ++k) {
    if (math::magnitude(conditions.missing[k]) > kMet) return false;
  }
  return true;
}

// The least change: C^T y with C C^T y = missing. False where the ticks cannot turn the transfer.
bool change_least(const Conditions& conditions, LinearSplit& split) {
  constexpr double kLeastRow = 1e-8;  // of the squares of a row: what it is made of is rounding
  LinearSystem<kConditions> system = {};
  system.clear(kConditions);
  for (size_t k = 0; k < kConditions; ++k) {
    for (size_t m = 0; m < kConditions; ++m) {
      for (uint32_t i = 0; i < split.count; ++i) system.row[k][m] += conditions.row[k][i] * conditions.row[m][i];
    }
    system.right(k) = conditions.missing[k];
    if (system.row[k][k] < kLeastRow) return false;
  }
  double y[kConditions] = {};
  if (!system.solve(y)) return false;
  for (uint32_t i = 0; i < split.count; ++i) {
    for (size_t k = 0; k < kConditions; ++k) split.taps[i].amplitude += conditions.row[k][i] * y[k];
  }
  return true;
}

}  // namespace

Placed nearest_train(const Cascade& train, double damping_ratio, double cycles_a_tick, Cascade& out) {
  LinearSplit split;
  if (!split_linearly(train, cycles_a_tick, split)) return Placed::kTooManyTaps;
  constexpr int kMostWidenings = 4;
  for (int i = 0; i <= kMostWidenings; ++i) {
    const Conditions conditions = conditions_of(train, damping_ratio, cycles_a_tick, split);
    if (are_met(conditions) || change_least(conditions, split)) {
      out = Cascade{};
      out.add(split.taps, split.count);
      return Placed::kYes;
    }
    for (int k = 0; k < 2; ++k) {
      if (!split.add(split.first_free(), 0.0)) return Placed::kTooManyTaps;
    }
  }
  return Placed::kCannot;
}

}  // namespace stillpoint
