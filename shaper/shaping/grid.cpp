// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/grid.hpp"

#include "shaper/base/linear.hpp"
#include "shaper/shaping/zv.hpp"

namespace stillpoint {

namespace {

constexpr size_t kMaxTrainTaps = 2 * kMaxZeros - 1;  // of the extra-insensitive, whose zeros are at most four

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

}  // namespace stillpoint
