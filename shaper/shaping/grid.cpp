// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/grid.hpp"

#include "shaper/base/linear.hpp"
#include "shaper/shaping/zv.hpp"

namespace stillpoint {

namespace {

constexpr size_t kMaxTrainTaps = 2 * kMaxZeros - 1;  // of the extra-insensitive, whose zeros are at most four

// exp(lambda (tick - last)) at a mode.
Complex turned(const Complex& exponent, double tick, double last) {
  const double angle = exponent.im * tick;
  return math::exp(exponent.re * (tick - last)) * Complex{math::cos(angle), math::sin(angle)};
}

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

// What the impulses leave at the mode, counted from the `last` tick.
Complex wanted_transfer(const Cascade& train, double damping_ratio, double cycles_a_tick, double last) {
  const double end = train.impulses[train.impulse_count - 1].time / cycles_a_tick;
  const Complex left = transfer(train.impulses, train.impulse_count, 1.0, damping_ratio).value;
  if (square_of(left) < math::square(kZeroByDesign)) return Complex{};
  return math::exp(exponent_of(cycles_a_tick, damping_ratio).re * (end - last)) * left;
}

// Less than gains resolve. A long train that ends on a tick has no other tap that counts at the mode: nothing to solve.
bool is_nothing(const double (&missing)[3]) {
  constexpr double kNothing = 2e-10;
  return math::abs(missing[0]) < kNothing && math::abs(missing[1]) < kNothing && math::abs(missing[2]) < kNothing;
}

}  // namespace

Cascade cascade_on_grid(const Zero* zeros, uint32_t count, double cycles_a_tick) {
  Cascade out{};
  for (uint32_t i = 0; i < count; ++i) {
    const ZvTaps zv = zv_taps(cycles_a_tick * zeros[i].ratio, zeros[i].damping_ratio);
    const double delay = zv.delay;
    const Impulse taps[] = {{0.0, zv.gain[0]}, {delay, zv.gain[1]}, {delay + 1.0, zv.gain[2]}};
    out.add(taps, 3);
  }
  return out;
}

SplitTicks split_ticks(const Cascade& train, double cycles_a_tick) {
  SplitTicks ticks{};
  uint32_t next = 1;
  for (uint32_t i = 1; i < train.impulse_count; ++i) {
    uint32_t tick = static_cast<uint32_t>(train.impulses[i].time / cycles_a_tick);
    if (tick < next) tick = next;
    ticks.tick[ticks.count++] = tick;
    next = tick + 2;
  }
  return ticks;
}

bool train_on_grid(const Zero* zeros, uint32_t count, const SplitTicks& ticks, double cycles_a_tick, Cascade& out) {
  Impulse taps[kMaxTrainTaps] = {};
  for (uint32_t i = 0; i < ticks.count; ++i) {
    taps[2 * i + 1].time = ticks.tick[i];
    taps[2 * i + 2].time = ticks.tick[i] + 1.0;
  }
  const uint32_t tap_count = 2 * ticks.count + 1;
  const double last = taps[tap_count - 1].time;
  LinearSystem<kMaxTrainTaps> system;
  system.clear(tap_count);
  for (uint32_t i = 0; i < tap_count; ++i) system.row[0][i] = 1.0;
  system.right(0) = 1.0;
  for (uint32_t k = 0; k < count; ++k) {
    const Complex exponent = exponent_of(cycles_a_tick * zeros[k].ratio, zeros[k].damping_ratio);
    for (uint32_t i = 0; i < tap_count; ++i) {
      const Complex q = turned(exponent, taps[i].time, last);
      system.row[2 * k + 1][i] = q.re;
      system.row[2 * k + 2][i] = q.im;
    }
  }
  double gains[kMaxTrainTaps] = {};
  if (!system.solve(gains)) return false;
  for (uint32_t i = 0; i < tap_count; ++i) taps[i].amplitude = gains[i];
  out = Cascade{};
  out.add(taps, tap_count);
  return true;
}

bool follow_signs(const Cascade& train, SplitTicks& ticks) {
  bool moved = false;
  for (uint32_t i = 0; i < ticks.count; ++i) {
    const double early = train.impulses[2 * i + 1].amplitude;
    const double late = train.impulses[2 * i + 2].amplitude;
    const uint32_t lowest = i == 0 ? 1 : ticks.tick[i - 1] + 2;
    if (late < 0.0 && early > -late && ticks.tick[i] > lowest) {
      --ticks.tick[i];
      moved = true;
    } else if (early < 0.0 && late > -early && (i + 1 == ticks.count || ticks.tick[i] + 3 <= ticks.tick[i + 1])) {
      ++ticks.tick[i];
      moved = true;
    }
  }
  return moved;
}

bool nearest_train_on_grid(const Cascade& train, double damping_ratio, double cycles_a_tick, Cascade& out) {
  LinearSplit split;
  if (!split_linearly(train, cycles_a_tick, split)) return false;
  const double last = split.taps[split.count - 1].time;
  const Complex exponent = exponent_of(cycles_a_tick, damping_ratio);
  const Complex wanted = wanted_transfer(train, damping_ratio, cycles_a_tick, last);

  // change = C^T y with C C^T y = what the linear split misses
  double row[3][kMaxTaps];
  double missing[3] = {1.0, wanted.re, wanted.im};
  for (uint32_t i = 0; i < split.count; ++i) {
    const Complex q = turned(exponent, split.taps[i].time, last);
    row[0][i] = 1.0;
    row[1][i] = q.re;
    row[2][i] = q.im;
    for (int k = 0; k < 3; ++k) missing[k] -= row[k][i] * split.taps[i].amplitude;
  }
  out = Cascade{};
  if (is_nothing(missing)) {
    out.add(split.taps, split.count);
    return true;
  }
  LinearSystem<3> system;
  system.clear(3);
  for (size_t k = 0; k < 3; ++k) {
    for (size_t m = 0; m < 3; ++m) {
      for (uint32_t i = 0; i < split.count; ++i) system.row[k][m] += row[k][i] * row[m][i];
    }
    system.right(k) = missing[k];
  }
  double y[3] = {};
  if (!system.solve(y)) return false;
  for (uint32_t i = 0; i < split.count; ++i) {
    for (int k = 0; k < 3; ++k) split.taps[i].amplitude += row[k][i] * y[k];
  }
  out.add(split.taps, split.count);
  return true;
}

}  // namespace stillpoint
