// SPDX-License-Identifier: Apache-2.0
// Motion that makes an arm ring, or shows how it answers a frequency. Prepared by the background, which knows all of it
// before anything moves; run by the tick in integers.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/base/status.hpp"

namespace stillpoint {

// kBump: out and back once, as short as the limits and the band allow, so that its spectrum reaches over the band.
// kSteppedSine: one frequency after the other, logarithmically apart, each with whole periods, faded in and out.
// kChirp: through the band once, the frequency rising.
// Every one begins and ends standing where it began, its difference 0.
enum class ExcitationKind : uint8_t { kBump, kSteppedSine, kChirp };

struct ExcitationConfig {
  ExcitationKind kind;
  double tick_s;
  double amplitude;  // counts, how far from where it begins at most; above 0, at most `travel`
  double travel;     // counts: the room there is, either way
  double velocity;   // counts/s, acceleration counts/s^2 and jerk counts/s^3: what it keeps below
  double acceleration;
  double jerk;
  double low_hz;  // the band, low < high < 0.45 / tick
  double high_hz;
  uint32_t steps;  // of a stepped sine, 2 to kMostExcitationSteps

  Status validate() const;
};

constexpr uint32_t kMostExcitationSteps = 64;

// What will happen, before it does. Peaks of what the tick will emit, sampled.
struct Announcement {
  double travel;        // counts, the furthest from where it begins, either way
  double velocity;      // counts/s
  double acceleration;  // counts/s^2
  double jerk;          // counts/s^3
  double duration_s;
};

// What a frequency was answered with: the sensor's samples over the setpoint, as the sum of one bin each.
struct BinAnswer {
  double frequency_hz;
  double re;  // sensor's unit a count: the transfer from setpoint to sensor
  double im;
  double spread;  // standard deviation of either part
};

}  // namespace stillpoint
