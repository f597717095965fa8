// SPDX-License-Identifier: Apache-2.0
// From an unknown arm to a still one: excite, capture, identify, recommend, preview, apply, verify, keep or undo.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/axis/axis_core.hpp"
#include "shaper/base/meanwhile.hpp"
#include "shaper/identify/capture.hpp"
#include "shaper/identify/excitation.hpp"
#include "shaper/identify/identify.hpp"
#include "shaper/shaping/shaper_spec.hpp"

namespace stillpoint {

// The numbers of all these are the drive's register values: never renumbered.

// kAuto: the move, and if its ringing does not tell, the bump, and then the stepped sine.
enum class TuneExcitation : uint8_t { kAuto, kMove, kBump, kSteppedSine, kChirp };
constexpr uint32_t kTuneExcitations = 5;

// kAuto: the accelerometer where it has ever read two different values, else the following error.
enum class TuneSource : uint8_t { kAuto, kAccelerometer, kFollowingError };
constexpr uint32_t kTuneSources = 3;

// kProposed waits for accept, undo or abort. kKept, kUndone, kFailed and kIdle are where it ends.
enum class TuneState : uint8_t {
  kIdle,
  kExciting,
  kCapturing,
  kIdentifying,
  kProposed,
  kApplying,
  kVerifying,
  kKept,
  kUndone,
  kFailed  // `finding` says why
};

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
};

// What is proposed: a ZV or its relatives a mode, robust by as much as the mode is uncertain.
struct TuneProposal {
  uint32_t spec_count;  // 0: nothing
  ShaperSpec specs[kMostComponents];
  double delay_s;  // centroid
  double length_s;
  double residual;  // predicted: the worst over what is not known of any mode, weighted by its part in the ringing
};

struct TuneReport {
  TuneState state;
  uint32_t progress_percent;
  TuneExcitation excited_by;      // what told, or was tried last
  TuneSource source;              // that was listened to
  bool source_enough;             // of the following error: it tells f as well as a shaper needs it
  Announcement announced;         // of the excitation under way or done
  Identification identification;  // its finding is that of the whole, also kTravelLimit and kAborted
  CaptureFlaws flaws;             // of the record it is from
  TuneProposal proposal;
  double
      plain_ringing;  // root mean square of the record after the plain move, of its modes alone, in the sensor's unit
  double shaped_ringing;  // after the shaped one; both 0 until then
  Status refusal;         // of the axis, where that ended it
};

// What one tick saw.
struct TuneSample {
  Signal setpoint;
  Signal position;
  int32_t acceleration;
  bool fresh;  // position and acceleration are new
};

// Memory. The record and the fit are the tuner's own; the transforms borrow the axis's spare shaper (lend_memory),
// which no one needs while a record is looked at. 8 + 5.3 + 16 KB.
struct TuneMemory {
  static constexpr size_t kSamples = 2048;
  CaptureWord record[kSamples];
  DecayFit fit;
};

// Owns the axis while `busy`: whoever commands it besides gets kBusy, or aborts the tuning first. A stop or fault from
// elsewhere aborts it.
//
// `tick` is the tick's, after AxisCore::tick; everything else is the background's. Zero-initialised storage is valid.
class AutoTune {
 public:
  void begin(AxisCore& axis, TuneMemory& memory);

  // At rest. Refuses by name what cannot be done within travel and limits; nothing has moved then. `announced` (may be
  // null): the first motion, which `service` starts.
  Status start(const TuneConfig& config, Announcement* announced);

  // At any time: what moves comes to rest by the axis's halt, the shaper of before is put back.
  void abort();

  // In kProposed: apply, then verify. kBusy otherwise.
  Status accept();

  // In kProposed: drop it. In kKept: the shaper of before comes back. kBusy otherwise.
  Status undo();

  // As often as possible. Long while it identifies and designs; calls `meanwhile` then.
  void service(const Meanwhile& meanwhile);

  bool busy() const;
  const TuneReport& report() const { return report_; }

  // --- tick -------------------------------------------------------------------------------------------------------

  void tick(const TuneSample& sample);

 private:
  TuneReport report_ = {};
};

}  // namespace stillpoint
