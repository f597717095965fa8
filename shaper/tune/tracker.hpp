// SPDX-License-Identifier: Apache-2.0
// Modes that change slowly, followed from one move's ringing to the next. Background; single precision, 1e-7 of which
// no record tells.
#pragma once

#include <stddef.h>

#include "shaper/identify/identification.hpp"
#include "shaper/shaping/mode.hpp"

namespace stillpoint {

// Frequency and damping of each mode, moved towards what a record says of it by as much as that is surer than what is
// known: a scalar Kalman filter of a random walk, its gain kept between kLeastGain (so that it never stops following)
// and kMostGain (so that no single record carries it away). A record that lies further off than kOutlier deviations is
// left out, but makes what is known less sure, so that an arm that did change is believed after a few. Neither leaves
// the bounds around where it began. Zero-initialised it is off and has no modes.
class ModeTracker {
 public:
  static constexpr float kLeastGain = 0.02F;
  static constexpr float kMostGain = 0.5F;
  static constexpr float kOutlier = 4.0F;
  static constexpr float kFrequencyBound = 0.2F;  // of where it began, either way
  static constexpr float kDampingBound = 0.8F;
  static constexpr float kFrequencyWalk = 2e-3F;  // from one record to the next, standard deviation over the start
  static constexpr float kDampingWalk = 0.05F;
  static constexpr double kLeastConfidence = 0.5;  // of a mode that says anything

  // `count` valid modes at most kMostComponents, rising or not; those beyond are not followed. Off until `enable`.
  void begin(const Mode* modes, size_t count);
  void enable(bool on) { on_ = on; }

  // After a move. True where a mode was moved. Takes modes that are viscous or not, found with enough confidence within
  // the bounds, each the nearest of those followed; anything else, and everything while it is off, changes nothing.
  bool follow(const Identification& found);

  size_t count() const { return count_; }
  float frequency_hz(size_t k) const { return state_[k].of[kFrequency].value; }
  float damping_ratio(size_t k) const { return state_[k].of[kDamping].value; }
  Mode mode(size_t k) const { return {static_cast<double>(frequency_hz(k)), static_cast<double>(damping_ratio(k))}; }
  size_t left_out() const { return left_out_; }  // outliers, since `begin`

 private:
  struct Estimate {
    float value;
    float variance;
    float began_at;

    void begin(double at, float part);
    bool is_outlier(float measured, float variance_of_it, float part) const;
    void move(float measured, float variance_of_it, float bound);
  };
  enum { kFrequency, kDamping, kEstimates };
  struct Tracked {
    Estimate of[kEstimates];
  };

  bool follow_one(const IdentifiedMode& mode);

  bool on_ = false;
  size_t count_ = 0;
  size_t left_out_ = 0;
  Tracked state_[kMostComponents] = {};
};

}  // namespace stillpoint
