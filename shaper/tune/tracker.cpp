// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/tracker.hpp"

namespace stillpoint {

namespace {

constexpr double kForgets = 4.0;  // of the variance, a record left out

double within(double value, double low, double high) { return value < low ? low : value > high ? high : value; }

}  // namespace

void ModeTracker::Estimate::begin(double at, double walk_std, double bound) {
  value = at;
  walk = math::square(walk_std * at);
  variance = walk;
  low = at * (1.0 - bound);
  high = at * (1.0 + bound);
}

bool ModeTracker::Estimate::is_outlier(double measured, double variance_of_it) const {
  return math::square(measured - value) > kOutlier * kOutlier * (variance + walk + variance_of_it);
}

void ModeTracker::Estimate::move(double measured, double variance_of_it) {
  variance += walk;
  const double gain = within(variance / (variance + variance_of_it), kLeastGain, kMostGain);
  value = within(value + gain * (measured - value), low, high);
  variance = math::square(1.0 - gain) * variance + math::square(gain) * variance_of_it;
}

void ModeTracker::begin(const Mode* modes, size_t count) {
  on_ = false;
  left_out_ = 0;
  count_ = count < kMostComponents ? count : kMostComponents;
  for (size_t k = 0; k < count_; ++k) {
    state_[k].frequency.begin(modes[k].frequency_hz, kFrequencyWalk, kFrequencyBound);
    state_[k].damping.begin(modes[k].damping_ratio, kDampingWalk, kDampingBound);
  }
}

bool ModeTracker::follow(const Identification& found) {
  bool moved = false;
  if (!on_ || found.finding != Finding::kFound) return false;
  for (size_t k = 0; k < found.mode_count; ++k) moved = follow_one(found.mode[k]) || moved;
  return moved;
}

bool ModeTracker::follow_one(const IdentifiedMode& mode) {
  if (!(mode.confidence >= kLeastConfidence)) return false;
  Tracked* nearest = nullptr;
  for (size_t k = 0; k < count_; ++k) {
    const auto distance = [&](const Tracked& to) { return math::abs(mode.frequency_hz - to.frequency.value); };
    if (nearest == nullptr || distance(state_[k]) < distance(*nearest)) nearest = &state_[k];
  }
  if (nearest == nullptr) return false;
  Estimate& frequency = nearest->frequency;
  Estimate& damping = nearest->damping;
  if (mode.frequency_hz < frequency.low || mode.frequency_hz > frequency.high) return false;
  const double of_frequency = math::square(mode.frequency_std_hz);
  const double of_damping = math::square(mode.damping_std);
  if (frequency.is_outlier(mode.frequency_hz, of_frequency) || damping.is_outlier(mode.damping_ratio, of_damping)) {
    frequency.variance = kForgets * (frequency.variance + frequency.walk);
    damping.variance = kForgets * (damping.variance + damping.walk);
    ++left_out_;
    return false;
  }
  frequency.move(mode.frequency_hz, of_frequency);
  damping.move(mode.damping_ratio, of_damping);
  return true;
}

}  // namespace stillpoint
