// SPDX-License-Identifier: Apache-2.0
// What can be said of an arm from its ringing.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/identify/decay_model.hpp"

namespace stillpoint {

// Found, or why not. The last two are of an identification that moves the axis itself.
enum class Finding : uint8_t {
  kFound,
  kNoMode,       // nothing rings: noise, a constant, a drift, a hum that does not decay
  kNoisy,        // something rings, and cannot be told well enough
  kSaturated,    // the sensor was at its end: flat tops
  kTooShort,     // fewer than three periods, or next to no samples
  kTravelLimit,  // no room to excite the arm
  kAborted,
};

// One word, as in the command line's JSON: "ok", "no_mode", ...
const char* text(Finding finding);

struct IdentifiedMode {
  double frequency_hz;      // natural (undamped)
  double damping_ratio;     // the mean over the decay, weighted by what the record says of each part
  double amplitude;         // of the first sample, in the record's unit
  double frequency_std_hz;  // one standard deviation, with what the two parts of the decay differ by where they do
  double damping_std;
  double confidence;     // 0 to 1
  bool viscous;          // false where the damping changes with the amplitude: friction, or a large swing
  double damping_early;  // of the first part of the decay and of the rest; both 0 where the decay was too short for two
  double damping_late;
};

struct Identification {
  Finding finding;
  size_t mode_count;                     // 0 unless kFound
  IdentifiedMode mode[kMostComponents];  // strongest first
  double confidence;                     // of the strongest mode; 0 unless kFound
  double noise;                          // root mean square of what the model leaves of the record
  double hum_hz;                         // the strongest sinusoid that does not decay, 0 where there is none
  DecayModel model;                      // all that was fitted, hum and drift too
};

}  // namespace stillpoint
