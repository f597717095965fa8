// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/blend_window.hpp"

namespace stillpoint {

namespace {

// Wraps: the samples of a line that has just been filled may lie anywhere.
int64_t difference(int64_t a, int64_t b) {
  return static_cast<int64_t>(static_cast<uint64_t>(a) - static_cast<uint64_t>(b));
}

// Room for a sum of four of them.
constexpr double kLargestLimit = 1152921504606846976.0;  // 2^60

[[gnu::noinline]] int64_t whole(double limit, int64_t rounding) {
  return static_cast<int64_t>(limit < kLargestLimit ? limit : kLargestLimit) + rounding;
}

uint64_t magnitude(int64_t value) {
  return value < 0 ? UINT64_C(0) - static_cast<uint64_t>(value) : static_cast<uint64_t>(value);
}

int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

}  // namespace

BlendLimits BlendLimits::make(const AxisLimits& limits, bool jerk_limited, double tick_s, uint32_t stages,
                              bool forward) {
  const int64_t rounding = int64_t{stages} + 2;
  const double lsb_tick = tick_s * static_cast<double>(kSignalPerCount);
  const double lsb_tick_2 = lsb_tick * tick_s;
  const double jerk = jerk_limited ? limits.larger_jerk() * lsb_tick_2 * tick_s : kLargestLimit;
  return BlendLimits{whole(limits.velocity * lsb_tick, rounding),
                     whole(limits.acceleration * lsb_tick_2, 2 * rounding),
                     whole(limits.deceleration * lsb_tick_2, 2 * rounding),
                     whole(jerk, 4 * rounding),
                     rounding,
                     forward};
}

void Stream::next(Signal signal, bool forward) {
  const int64_t step = forward ? difference(signal, newest) : difference(newest, signal);
  const int64_t change = difference(step, velocity);
  jerk = difference(change, acceleration);
  newest = signal;
  velocity = step;
  acceleration = change;
}

Quantity Stream::broken(const BlendLimits& limits) const {
  if (velocity > limits.velocity || velocity < -limits.velocity) return Quantity::kVelocity;
  if (acceleration > limits.acceleration) return Quantity::kAcceleration;
  if (acceleration < -limits.deceleration) return Quantity::kDeceleration;
  if (jerk > limits.jerk || jerk < -limits.jerk) return Quantity::kJerk;
  return Quantity::kNone;
}

BlendSearch::BlendSearch(const Track& track, const BlendLimits& limits, Shaper& from, Shaper& to)
    : track_(track),
      limits_(limits),
      from_(from),
      to_(to),
      stands_(track.cruises() ? kNeverStands : track.duration_ticks + from.length_ticks()) {}

// Fed for its length, a line holds what it would hold had it run for ever; three ticks more give the differences.
void BlendSearch::start_at(uint32_t first) {
  const uint32_t from_length = from_.length_ticks();
  const uint32_t to_length = to_.length_ticks();
  const uint32_t settle = (from_length > to_length ? from_length : to_length) + 3;
  tick_ = first > settle ? first - settle : 0;
  sampler_.begin_at(track_, tick_);
  const Signal position = sampler_.position();
  from_.fill(position);
  to_.fill(position);
  old_ = Stream{position, 0, 0, 0};
  new_ = old_;
  while (tick_ < first) advance();
}

void BlendSearch::advance() {
  ++tick_;
  const Signal input = sampler_.tick();
  old_.next(from_.tick(input), limits_.forward);
  new_.next(to_.tick(input), limits_.forward);
}

// Twice what the ramp's own part may be when the rest of the stream is at the opposite limit: a quick way past the
// ramps that are far too short.
bool BlendSearch::gap_leaves_room(uint32_t order) const {
  const uint64_t gap = magnitude(difference(new_.newest, old_.newest));
  const uint64_t acceleration = static_cast<uint64_t>(limits_.acceleration + limits_.deceleration);
  return gap >> (order + 1) <= 2 * static_cast<uint64_t>(limits_.velocity) &&
         gap >> (2 * order + 1) <= 2 * acceleration &&
         gap >> (3 * order + 1) <= 4 * static_cast<uint64_t>(limits_.jerk);
}

// A new try of an order each tick while the ones before it fail at once, and spread over the ramp's length while they
// live.
void BlendSearch::begin_tries() {
  if (!old_.keeps(limits_, -limits_.velocity)) return;
  for (uint32_t order = kLeastOrder; order <= kMostOrder; ++order) {
    if (tick_ + BlendRamp::ticks(order) > stands_) return;
    if (!gap_leaves_room(order)) continue;
    Try* free = nullptr;
    bool crowded = false;
    for (Try& one : tries_[order - kLeastOrder]) {
      if (!one.alive) free = &one;
      crowded = crowded || (one.alive && tick_ - one.begin < BlendRamp::ticks(order) / kTries);
    }
    if (free == nullptr || crowded) continue;
    free->ramp.begin(order);
    free->stream = old_;
    free->begin = tick_;
    free->alive = true;
  }
}

// True when one has ended, within the limits.
bool BlendSearch::step_tries(BlendWindow& window) {
  const int64_t lowest = least(0, least(old_.velocity, new_.velocity)) - limits_.rounding;
  bool ended = false;
  for (uint32_t order = kLeastOrder; order <= kMostOrder; ++order) {
    for (Try& one : tries_[order - kLeastOrder]) {
      if (!one.alive) continue;
      one.stream.next(one.ramp.tick(old_.newest, new_.newest), limits_.forward);
      one.alive = one.stream.keeps(limits_, lowest);
      if (!one.alive || !one.ramp.done()) continue;
      one.alive = false;
      ended = true;
      window = BlendWindow{one.begin, order};
    }
  }
  return ended;
}

bool BlendSearch::find(uint32_t first, bool proved, BlendWindow& window, uint32_t& resume) {
  resume = UINT32_MAX;
  if (first >= stands_) return false;
  uint32_t end = stands_;
  if (!proved) {
    const uint32_t all_stand = track_.duration_ticks + to_.length_ticks() + 3;
    end = all_stand > stands_ ? all_stand : stands_;
    if (end - first > kLongestBlendProofTicks) {
      resume = end - kLongestBlendProofTicks;
      return false;
    }
  } else if (end - first > kLongestBlendSearchTicks) {
    end = first + kLongestBlendSearchTicks;
    resume = first + kLongestBlendSearchTicks / 2;
  }
  start_at(first);
  bool found = false;
  for (;;) {
    if (tick_ < resume) begin_tries();
    if (tick_ >= end) return found;
    advance();
    if (!proved && !new_.keeps(limits_, -limits_.velocity)) found = false;
    BlendWindow ended{};
    if (step_tries(ended) && !found) {
      window = ended;
      found = true;
    }
    if (found && proved) return true;
  }
}

}  // namespace stillpoint
