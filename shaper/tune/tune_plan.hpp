// SPDX-License-Identifier: Apache-2.0
// What a tuning is asked for, whether it can be done, and what will move. Background; doubles.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/axis/axis_config.hpp"
#include "shaper/axis/axis_core.hpp"
#include "shaper/identify/bin.hpp"
#include "shaper/identify/excitation.hpp"

namespace stillpoint {

// The numbers are the drive's register values: never renumbered.

// kAuto: the move; if its ringing does not tell, the bump; and if that does not, the stepped sine, each where there is
// room and amplitude for it.
enum class TuneExcitation : uint8_t { kAuto, kMove, kBump, kSteppedSine, kChirp };
constexpr uint32_t kTuneExcitations = 5;

// kAuto: the accelerometer where it has ever read two different values, else the following error.
enum class TuneSource : uint8_t { kAuto, kAccelerometer, kFollowingError };
constexpr uint32_t kTuneSources = 3;

struct TuneConfig {
  TuneExcitation excitation;
  TuneSource source;
  // The move that excites and, back to where it began, verifies. Its target may be on either side; its limits are those
  // of every excitation. With a zero_delay the verification is so too.
  Move move;
  double amplitude_counts;  // of the bump, the sine and the chirp
  double travel_counts;     // no excitation leaves [start - travel, start + travel]; the move neither
  double low_hz;            // the band in which modes are looked for
  double high_hz;
  double tolerance;       // residual ratio wanted over what is not known of the modes
  bool accept_by_itself;  // goes on from kProposed
  // What the accelerometer reads at its ends, raw: there or beyond it is saturated. lowest >= highest: it has none.
  int32_t sensor_lowest;
  int32_t sensor_highest;
  uint32_t samples;  // of a record, at most what the memory holds; 0: that
};

// How the ringing after a motion is recorded.
struct ListenPlan {
  uint32_t samples;
  uint32_t decimation;
  uint32_t pre_trigger;     // samples
  double rate_hz;           // of the samples
  uint32_t window_ticks;    // see RestWatch
  uint32_t patience_ticks;  // the same
  Signal tolerance;         // of the encoder at rest, for the peak velocity announced
};

// Everything but `tolerance`: the least decimation whose record of `samples` holds four periods of `low_hz`, as far as
// `high_hz` lets it. Refuses a band as plan_tuning does.
Status plan_listening(double low_hz, double high_hz, double tick_s, uint32_t samples, ListenPlan& listen);

// A tuning that was found to be possible.
struct TunePlan {
  Announcement announced;  // the excitation; with kAuto the larger of move and bump in each
  bool has_bump;           // it was prepared
  bool bump_forward;       // to rising counts
  int32_t home_counts;     // where it begins, as the target of the move back
  Signal home;             // the same, and the move's target, as setpoints
  Signal target;
  ListenPlan listen;
};

// Refuses, by name, with nothing done: what AxisCore::command would of the move behind no shaper; a distance of 0
// (kNotPositive kDistance) or beyond the travel (kAboveMaximum kTravel), where it is the move that excites; what
// Excitation::prepare does of the bump and of the sine, and one that a soft limit leaves no room for
// (kAboveMaximum kAmplitude, kAboveMaximum kTravel beyond the travel), where kAuto does without; a band that is not
// finite, rising, above zero and at most 0.4 of the tick rate, or whose low end has fewer than three periods in the
// longest record that its high end allows (kFrequency); a tolerance outside [kMinTolerance, kMaxTolerance]; an
// excitation or source that there is not (kKind); less than kLeastTuneMemory doubles of
// `memory` (kLineTooShort). The axis at rest. `samples`: room in the record. `excitation`: nobody's; left
// with the sine where that is what excites. Cost with a sine: see Excitation::prepare.
Status plan_tuning(AxisCore& axis, const TuneConfig& config, size_t samples, size_t memory, Excitation& excitation,
                   TunePlan& plan);

// Once more the bump of a plan.
Status prepare_bump(const AxisCore& axis, const TuneConfig& config, Excitation& bump, Announcement& announced);

// The sine, or the chirp where that is asked for, from where the axis stands, which goes either way; `announced` grows
// to the larger in each of that and what it was. As many steps as are a tenth apart, kLeastSteps to kMostBins.
constexpr uint32_t kLeastSteps = 16;
Status prepare_sine(const AxisCore& axis, const TuneConfig& config, const TunePlan& plan, Excitation& sine,
                    Announcement& announced, const Meanwhile& meanwhile = {});

constexpr size_t kLeastTuneMemory = 256;

}  // namespace stillpoint
