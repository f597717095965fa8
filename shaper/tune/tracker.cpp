// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/tracker.hpp"

namespace stillpoint {

namespace {

constexpr float kForgets = 4.0F;  // of the variance, a record left out
constexpr float kInside = 1e-6F;  // the bounds, for rounding

// Of frequency and damping.
constexpr float kWalk[] = {ModeTracker::kFrequencyWalk, ModeTracker::kDampingWalk};
constexpr float kBound[] = {ModeTracker::kFrequencyBound, ModeTracker::kDampingBound};

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

void ModeTracker::Estimate::move(float measured, float variance_of_it, float bound) {
  const float gain = within(variance / (variance + variance_of_it), kLeastGain, kMostGain);
  const float reach = (bound - kInside) * began_at;
  value = within(value + gain * (measured - value), began_at - reach, began_at + reach);
  variance = square(1.0F - gain) * variance + square(gain) * variance_of_it;
}

void ModeTracker::begin(const Mode* modes, size_t count) {
  on_ = false;
  left_out_ = 0;
  count_ = count < kMostComponents ? count : kMostComponents;
  for (size_t k = 0; k < count_; ++k) {
    const double at[] = {modes[k].frequency_hz, modes[k].damping_ratio};
    for (size_t i = 0; i < kEstimates; ++i) state_[k].of[i].begin(at[i], kWalk[i]);
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
  const float measured[] = {static_cast<float>(mode.frequency_hz), static_cast<float>(mode.damping_ratio)};
  const float variance[] = {square_of(mode.frequency_std_hz), square_of(mode.damping_std)};
  Tracked* nearest = nullptr;
  float least = 0.0F;
  for (size_t k = 0; k < count_; ++k) {
    const float distance = square(measured[kFrequency] - frequency_hz(k));
    if (nearest != nullptr && distance >= least) continue;
    nearest = &state_[k];
    least = distance;
  }
  if (nearest == nullptr) return false;
  Estimate* const of = nearest->of;
  const float began_at = of[kFrequency].began_at;
  if (square(measured[kFrequency] - began_at) > square(kFrequencyBound * began_at)) return false;
  bool outlier = false;
  for (size_t i = 0; i < kEstimates; ++i) outlier = outlier || of[i].is_outlier(measured[i], variance[i], kWalk[i]);
  for (size_t i = 0; i < kEstimates; ++i) {
    of[i].variance += square(kWalk[i] * of[i].began_at);
    if (outlier) {
      of[i].variance *= kForgets;
    } else {
      of[i].move(measured[i], variance[i], kBound[i]);
    }
  }
  if (outlier) ++left_out_;
  return !outlier;
}

}  // namespace stillpoint
