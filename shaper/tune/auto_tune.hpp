// SPDX-License-Identifier: Apache-2.0
// From an unknown arm to a still one: excite, capture, identify, recommend, preview, apply, verify, keep or undo.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/axis/axis_core.hpp"
#include "shaper/base/meanwhile.hpp"
#include "shaper/base/shared.hpp"
#include "shaper/identify/capture.hpp"
#include "shaper/identify/chirp_bins.hpp"
#include "shaper/identify/excitation.hpp"
#include "shaper/identify/identify.hpp"
#include "shaper/identify/stepped_sine.hpp"
#include "shaper/tune/choose.hpp"
#include "shaper/tune/rest_watch.hpp"
#include "shaper/tune/ringing.hpp"
#include "shaper/tune/tune_plan.hpp"

namespace stillpoint {

// The numbers are the drive's register values: never renumbered.
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

// `source_enough`: the deviations of f and zeta that the source gave are so small that the shaper proposed keeps the
// tolerance wherever in two of them either way the modes may be. For the following error, which shows the arm only as
// far as it shakes its motor, that is the question whether an accelerometer is needed.
struct TuneReport {
  TuneState state;
  uint32_t progress_percent;
  TuneExcitation excited_by;      // what told, or was tried last
  TuneSource source;              // that was listened to; as configured until it was
  bool source_enough;             // see below
  Announcement announced;         // of the excitation under way or done
  Identification identification;  // its finding is that of the whole, also kTravelLimit and kAborted
  CaptureFlaws flaws;             // of the record it is from
  TuneProposal proposal;
  // Root mean square of the ringing after the plain move, less noise (see ringing_of), in raw steps of the
  // accelerometer or in counts; and the most that it may be after the shaped one. 0 until then.
  double plain_ringing;
  double shaped_ringing;
  Status refusal;  // of the axis, where that ended it
};

// What one tick saw.
struct TuneSample {
  Signal setpoint;
  Signal position;
  int32_t acceleration;
  bool fresh;  // position and acceleration are new
};

// Who has the record, in rising order: a claim takes it from those below, who see that and give up.
enum class MemoryHolder : uint32_t { kNobody, kTracking, kScope, kTuning };

// What a sine or a chirp needs instead of a record.
struct SineMemory {
  Excitation excitation;
  union {
    SteppedBins bins;
    ChirpBins chirp;
  };
  BinAnswer answers[kMostBins];
  ResponseScratch scratch;
};

// Memory. The record and the fit are the tuner's own; the transforms borrow the axis's spare shaper (lend_memory),
// which no one needs while a record is looked at. 8 + 5.3 + 16 KB.
struct TuneMemory {
  static constexpr size_t kSamples = 2048;
  union {
    CaptureWord record[kSamples];
    Excitation excitation;  // while it moves nothing is recorded
    SineMemory sine;        // begins with the same
  };
  DecayFit fit;
  uint32_t holder;  // MemoryHolder; the background's, and read by the tick

  // Background. False where somebody above has it.
  bool claim(MemoryHolder who) {
    if (holder > static_cast<uint32_t>(who)) return false;
    store(holder, static_cast<uint32_t>(who));
    return true;
  }
  void release(MemoryHolder who) {
    if (held_by(who)) store(holder, static_cast<uint32_t>(MemoryHolder::kNobody));
  }
  // Either context.
  bool held_by(MemoryHolder who) const { return load(holder) == static_cast<uint32_t>(who); }
};
static_assert(sizeof(SineMemory) <= sizeof(TuneMemory::record), "a sine takes no more memory than a record");

// Owns the axis while `busy`: whoever commands it besides gets kBusy, or aborts the tuning first. A stop, or a reset
// that puts the axis elsewhere while it moves or listens, aborts it.
//
// What it does: takes the shaper in force off, moves to the target, records from where axis and motor rest,
// identifies, chooses, waits for `accept`, applies at rest, waits until the plain ringing has faded to a tenth (a
// minute at most), moves back and compares: the shaper is kept where the shaped ringing is at most half of the plain
// one, whatever noise may hide, and is undone otherwise. A record with gaps in more than 1 % of its ticks, or that
// looks clipped, is taken again once, on the way back. An ending other than kKept has the shaper of before in force;
// the axis then stands where its last motion led. Where the bump excites, alone or after a move that showed no mode
// or none that is known well enough for a shaper (kAuto), it is streamed through the axis, and a second one, shaped,
// verifies: like is compared with like. So is the stepped sine, alone or after a bump that told no more than the move
// did (kAuto); `announced` is then anew what it will be, and it begins with the next `service`. It leaves no ringing to
// compare, so a plain bump follows it and a shaped one verifies: a bump excites the whole band, where a move may leave
// an arm still by chance, and leads nowhere. What it leaves of a well damped arm is over within a period or two; what
// noise makes of both is reckoned with (see ringing_of). A sine whose sensor was at its end, or that has gaps, is not
// repeated.
//
// `service` must be called for an abort to be heard; it does not return while it identifies. A refusal of the axis ends
// it as kFailed, kAborted, with `refusal`.
//
// `tick` is the tick's, after AxisCore::tick; everything else is the background's. AxisCore::service is the caller's to
// call. Zero-initialised storage is valid. RAM: 2 KB, and TuneMemory.
class AutoTune {
 public:
  static constexpr int kErrorFractionBits = 16;  // of the following error, counts
  static constexpr double kCountsPerError = 1.0 / (1 << kErrorFractionBits);

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

  // --- what other moves leave (follow_moves.cpp) ------------------------------------------------------------------

  // While the tuner is not busy: waits for a motion and for the rest after it, records until the record is full or the
  // axis moves again, and is done. A tuning, or a scope that claims the memory, ends it. Nothing happens where somebody
  // else has the memory. Source and sensor's ends as in TuneConfig; `listen` as plan_listening makes it, with a
  // tolerance.
  void follow(TuneSource source, int32_t lowest, int32_t highest, const ListenPlan& listen);
  void stop_following();
  // kIdle where it does not follow, kFull with a record.
  CaptureState following() const;
  // Once full: what the record says. kAborted where it was given up, or the spare shaper's memory is not to be had: ask
  // again. kTooShort below `least` samples, kSaturated, kNoisy with gaps in more than 1 % of its ticks.
  Identification look_at_followed(uint32_t least, const Meanwhile& meanwhile);

  // --- tick -------------------------------------------------------------------------------------------------------

  void tick(const TuneSample& sample);

 private:
  enum : uint32_t { kNoStream, kStreams, kStreamOver };
  enum : uint32_t { kRecords, kHearsSine, kHearsChirp };
  enum class Step : uint8_t { kNone, kUnshape, kMove, kListen, kLook, kApply, kRestore };

  uint32_t progress_percent() const;
  bool at_rest() const;
  bool is_disturbed() const;
  void take_step(const Meanwhile& meanwhile);
  void take_off_shaper();
  void send_move();
  void send_stream();
  void try_next_or_fail(Finding finding, const Meanwhile& meanwhile);
  bool stream_was_lost() const;
  Status start_listening();
  void start_hearing();
  void listen();
  void look(const Meanwhile& meanwhile);
  void look_at_answers(const Meanwhile& meanwhile);
  Status identify_answers(const Meanwhile& meanwhile);
  bool record_is_flawed();
  void give_up_record(Finding finding);
  void look_at_plain(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile);
  void look_at_shaped(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile);
  void fit_modes(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile);
  Ringing ringing(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile) const;
  void drop_modes_outside_band();
  void apply(const Meanwhile& meanwhile);
  void put_back();
  void stop_listening();
  static Finding flaw_of(const CaptureFlaws& flaws, uint32_t ticks);
  CaptureFlaws recorded_flaws() const;
  uint32_t recorded_ticks() const { return capture_.samples() * plan_.listen.decimation; }
  bool ends_known() const;
  double* borrow(size_t& size);
  void end(TuneState state);
  void fail(Finding finding);
  void refused(const Status& status);
  void excite(const TuneSample& sample);
  void hear(const TuneSample& sample);
  void choose_source();
  int32_t value_of(const TuneSample& sample);

  AxisCore* axis_ = nullptr;
  TuneMemory* memory_ = nullptr;
  TuneConfig config_ = {};
  TunePlan plan_ = {};
  ShaperDesign before_ = {};  // in force when it began
  Step step_ = Step::kNone;
  TuneState ends_as_ = TuneState::kIdle;  // once the shaper of before is back
  bool verifying_ = false;
  bool answered_ = false;                      // by a sine: what is recorded now is only compared
  TuneExcitation by_ = TuneExcitation::kAuto;  // what excites now
  bool is_out_ = false;                        // stands where the move leads
  bool shaper_changed_ = false;                // `before_` is not in force
  bool handed_over_ = false;                   // the shaper that the step is about
  bool taken_again_ = false;                   // a record that was flawed
  bool working_ = false;                       // `meanwhile` may call everything but service
  bool abort_asked_ = false;
  uint32_t faded_at_ = 0;  // the axis's tick: the plain ringing would be in the way of the shaped one
  Signal expected_ = 0;    // where the motion under way ends
  TuneReport report_ = {};

  // Shared with the tick.
  uint32_t listens_ = 0;
  uint32_t stream_ = 0;       // kNoStream and so on
  uint32_t hears_ = 0;        // kRecords and so on
  uint32_t gaps_ = 0;         // of what is heard, ticks
  uint32_t to_error_ = 0;     // the following error, not the accelerometer
  uint32_t accelerates_ = 0;  // the accelerometer has read two different values
  uint32_t clipped_ = 0;      // ticks of the rest with a value at the sensor's end
  uint32_t stopped_ = 0;      // a quick stop was seen
  RestWatch watch_;
  Capture capture_;
  Record followed_ = {};  // once it has been taken from the capture
  // The tick's own.
  bool has_first_ = false;
  int32_t first_ = 0;
  int32_t last_ = 0;
};

}  // namespace stillpoint
