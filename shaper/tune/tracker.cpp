// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/tracker.hpp"

namespace stillpoint {

namespace {

constexpr float kForgets = 4.0F;  // of the variance, a record left out
constexpr float kInside = 1e-6F;  // the bounds, for rounding

float square(float value) { return value * value; }
float square_of(double value) { return square(static_cast<float>(value)); }

// `low` for what is no number.
float within(float value, float low, float high) { return value > high ? high : value > low ? value : low; }

}  // namespace

void ModeTracker::Estimate::begin(double at, float part) {
  began_at = value = static_cast<float>(at);
  variance = square(part * began_at);
}

bool ModeTracker::Estimate::is_outlier(float measured, float variance_of_it, float part) const {
  return square(measured - value) > square(kOutlier) * (variance + square(part * began_at) + variance_of_it);
}

void ModeTracker::Estimate::move(float measured, float variance_of_it, float part, float bound) {
  variance += square(part * began_at);
  const float gain = within(variance / (variance + variance_of_it), kLeastGain, kMostGain);
  const float reach = (bound - kInside) * began_at;
  value = within(value + gain * (measured - value), began_at - reach, began_at + reach);
  variance = square(1.0F - gain) * variance + square(gain) * variance_of_it;
}

void ModeTracker::Estimate::forget(float part) { variance = kForgets * (variance + square(part * began_at)); }

void ModeTracker::begin(const Mode* modes, size_t count) {
  on_ = false;
  left_out_ = 0;
  count_ = count < kMostComponents ? count : kMostComponents;
  for (size_t k = 0; k < count_; ++k) {
    state_[k].frequency.begin(modes[k].frequency_hz, kFrequencyWalk);
    state_[k].damping.begin(modes[k].damping_ratio, kDampingWalk);
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
  const auto measured = static_cast<float>(mode.frequency_hz);
  const auto measured_damping = static_cast<float>(mode.damping_ratio);
  Tracked* nearest = nullptr;
  float least = 0.0F;
  for (size_t k = 0; k < count_; ++k) {
    const float distance = square(measured - state_[k].frequency.value);
    if (nearest != nullptr && distance >= least) continue;
    nearest = &state_[k];
    least = distance;
  }
  if (nearest == nullptr) return false;
  Estimate& frequency = nearest->frequency;
  Estimate& damping = nearest->damping;
  if (square(measured - frequency.began_at) > square(kFrequencyBound * frequency.began_at)) return false;
  const float of_frequency = square_of(mode.frequency_std_hz);
  const float of_damping = square_of(mode.damping_std);
  if (frequency.is_outlier(measured, of_frequency, kFrequencyWalk) ||
      damping.is_outlier(measured_damping, of_damping, kDampingWalk)) {
    frequency.forget(kFrequencyWalk);
    damping.forget(kDampingWalk);
    ++left_out_;
    return false;
  }
  frequency.move(measured, of_frequency, kFrequencyWalk, kFrequencyBound);
  damping.move(measured_damping, of_damping, kDampingWalk, kDampingBound);
  return true;
}

}  // namespace stillpoint
