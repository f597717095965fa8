// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/group.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

bool same_stage(const ShaperDesign& a, const Stage& in_a, const ShaperDesign& b, const Stage& in_b) {
  if (in_a.tap_count != in_b.tap_count) return false;
  for (uint32_t i = 0; i < in_a.tap_count; ++i) {
    const Tap& tap_a = a.taps[in_a.first_tap + i];
    const Tap& tap_b = b.taps[in_b.first_tap + i];
    if (tap_a.delay_ticks != tap_b.delay_ticks || tap_a.gain != tap_b.gain) return false;
  }
  return true;
}

// How often the first `stages` stages of `design` are this one.
uint32_t occurrences(const ShaperDesign& design, uint32_t stages, const ShaperDesign& other, const Stage& stage) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < stages; ++i) count += same_stage(design, design.stages[i], other, stage) ? 1U : 0U;
  return count;
}

// Does the axis need this stage of its own once more than an earlier axis has it? Every stage of the group is so
// counted where it is needed first.
bool is_missing(const ShaperDesign* each, size_t axis, uint32_t index) {
  const ShaperDesign& own = each[axis];
  const uint32_t needed = occurrences(own, index + 1, own, own.stages[index]);
  for (size_t i = 0; i < axis; ++i) {
    if (occurrences(each[i], each[i].stage_count, own, own.stages[index]) >= needed) return false;
  }
  return true;
}

void append_stage(const ShaperDesign& from, const Stage& stage, ShaperDesign& to) {
  to.stages[to.stage_count++] = Stage{to.tap_count, stage.tap_count};
  for (uint32_t i = 0; i < stage.tap_count; ++i) to.taps[to.tap_count++] = from.taps[stage.first_tap + i];
}

bool has_room(uint32_t stages, uint32_t taps) {
  return stages <= ShaperDesign::kMaxStages && taps <= ShaperDesign::kMaxTaps;
}

Status no_room(uint32_t stages) {
  return refuse(Error::kTooManyStages, Quantity::kStages, stages, ShaperDesign::kMaxStages);
}

// The centroid in units of 2^-30 ticks: exact, below 2^(30 + 20) a tap.
int64_t exact_delay(const ShaperDesign& design) {
  int64_t sum = 0;
  for (uint32_t i = 0; i < design.tap_count; ++i) {
    sum += static_cast<int64_t>(design.taps[i].gain) * static_cast<int64_t>(design.taps[i].delay_ticks);
  }
  return sum;
}

int64_t slowest_delay(const ShaperDesign* each, size_t count) {
  int64_t slowest = exact_delay(each[0]);
  for (size_t i = 1; i < count; ++i) {
    const int64_t delay = exact_delay(each[i]);
    if (delay > slowest) slowest = delay;
  }
  return slowest;
}

Status check_room_for_delay(const ShaperDesign& design, int64_t delay) {
  constexpr int64_t kLongest = static_cast<int64_t>(kMaxStageTicks - 1) * kUnityGain;
  if (delay > kLongest) {
    return refuse(Error::kAboveMaximum, Quantity::kDelay, static_cast<double>(delay) / kUnityGain, kMaxStageTicks - 1);
  }
  if (delay > 0 && !has_room(design.stage_count + 1, design.tap_count + 3)) return no_room(design.stage_count + 1);
  return kOk;
}

void append_delay(int64_t delay, ShaperDesign& design) {
  uint32_t whole = static_cast<uint32_t>(delay >> kGainFractionBits);
  int32_t fraction = static_cast<int32_t>(delay & (kUnityGain - 1));
  if (fraction == 0) {  // d ticks are 1 after d - 1: a line shorter by one
    --whole;
    fraction = kUnityGain;
  }
  design.stages[design.stage_count++] = Stage{design.tap_count, 3};
  design.taps[design.tap_count++] = Tap{0, 0};
  design.taps[design.tap_count++] = Tap{whole, kUnityGain - fraction};
  design.taps[design.tap_count++] = Tap{whole + 1, fraction};
}

uint32_t larger(uint32_t a, uint32_t b) { return a > b ? a : b; }

// On a step high enough for the rounding of the signal not to count.
ContourLag lag_between(Shaper& first, Shaper& second, uint32_t length_ticks) {
  constexpr Signal kStep = INT64_C(1) << 60;
  double sum = 0.0;
  ContourLag lag{};
  for (uint32_t tick = 0; tick <= length_ticks; ++tick) {
    const double apart = static_cast<double>(first.tick(kStep) - second.tick(kStep)) / static_cast<double>(kStep);
    sum += apart;
    lag.corner_ticks = math::greater(lag.corner_ticks, math::magnitude(sum));
    lag.worst_ticks += math::magnitude(apart);
  }
  lag.steady_ticks = math::magnitude(sum);
  return lag;
}

void raise(const ContourLag& lag, uint32_t first_axis, uint32_t second_axis, ContourLag& most) {
  most.steady_ticks = math::greater(most.steady_ticks, lag.steady_ticks);
  most.corner_ticks = math::greater(most.corner_ticks, lag.corner_ticks);
  if (lag.worst_ticks <= most.worst_ticks) return;
  most.worst_ticks = lag.worst_ticks;
  most.first_axis = first_axis;
  most.second_axis = second_axis;
}

}  // namespace

Status common_shaper(const ShaperDesign* each, size_t count, ShaperDesign& out) {
  uint32_t stages = 0;
  uint32_t taps = 0;
  for (size_t axis = 0; axis < count; ++axis) {
    for (uint32_t i = 0; i < each[axis].stage_count; ++i) {
      if (!is_missing(each, axis, i)) continue;
      ++stages;
      taps += each[axis].stages[i].tap_count;
    }
  }
  if (!has_room(stages, taps)) return no_room(stages);
  ShaperDesign common{};
  for (size_t axis = 0; axis < count; ++axis) {
    for (uint32_t i = 0; i < each[axis].stage_count; ++i) {
      if (is_missing(each, axis, i)) append_stage(each[axis], each[axis].stages[i], common);
    }
  }
  out = common;
  return kOk;
}

Status equalise_delays(ShaperDesign* each, size_t count) {
  if (count == 0) return kOk;
  const int64_t slowest = slowest_delay(each, count);
  for (size_t i = 0; i < count; ++i) {
    const Status status = check_room_for_delay(each[i], slowest - exact_delay(each[i]));
    if (!status.ok()) return status;
  }
  for (size_t i = 0; i < count; ++i) {
    const int64_t delay = slowest - exact_delay(each[i]);
    if (delay > 0) append_delay(delay, each[i]);
  }
  return kOk;
}

ShaperCost cost_of(const ShaperDesign& design) {
  return ShaperCost{design.delay_ticks(), design.length_ticks(), design.line_length(), design.tap_count};
}

ShaperCost cost_of(const ShaperDesign* each, size_t count) {
  ShaperCost group{};
  for (size_t i = 0; i < count; ++i) {
    const ShaperCost axis = cost_of(each[i]);
    group.delay_ticks = math::greater(group.delay_ticks, axis.delay_ticks);
    group.length_ticks = larger(group.length_ticks, axis.length_ticks);
    group.line_signals += axis.line_signals;
    group.taps_per_tick += axis.taps_per_tick;
  }
  return group;
}

Status worst_lag(const ShaperDesign* each, size_t count, LineSample* memory, size_t capacity, ContourLag& lag) {
  ContourLag most{};
  for (uint32_t i = 0; i < count; ++i) {
    const size_t taken = Shaper::memory_needed(each[i]);
    for (uint32_t k = i + 1; k < count; ++k) {
      const size_t needed = taken + Shaper::memory_needed(each[k]);
      if (needed > capacity)
        return refuse(Error::kLineTooShort, Quantity::kDelay, static_cast<double>(needed),
                      static_cast<double>(capacity));
      Shaper first;
      Shaper second;
      Status status = first.configure(each[i], memory, taken, 0);
      if (status.ok()) status = second.configure(each[k], memory + taken, capacity - taken, 0);
      if (!status.ok()) return status;
      const uint32_t length = larger(each[i].length_ticks(), each[k].length_ticks());
      raise(lag_between(first, second, length), i, k, most);
    }
  }
  lag = most;
  return kOk;
}

}  // namespace stillpoint
