// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/auto_tune.hpp"

#include "shaper/base/math.hpp"
#include "shaper/base/shared.hpp"
#include "shaper/tune/ringing.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kGapsOfTicks = 100;   // one in so many that are recorded, at most
constexpr double kClearlyBetter = 0.5;   // of the plain ringing, at most
constexpr double kWorthProposing = 0.5;  // a shaper that may leave more is none
constexpr double kFaded = 0.1;           // of the plain ringing, what may be left of it when it is verified
constexpr double kFades = 2.302585 / (2.0 * math::kPi);  // to that, in periods times damping
constexpr double kLeastDecay = kFades / 60.0;            // frequency times damping: a minute is waited at most
constexpr double kLeastAmplitude = 0.002;                // of a mode over the strongest one's
constexpr uint32_t kMadeUpTicks = 4;                     // of the bump's stream; the tick misses none

Status busy_now() { return refuse(Error::kBusy, Quantity::kNone, 0.0); }

// Until every mode that matters has faded, from the first sample on.
double fading_time_s(const Identification& found) {
  double slowest = 0.0;
  for (size_t k = 0; k < found.mode_count; ++k) {
    const IdentifiedMode& mode = found.mode[k];
    const double decay = mode.frequency_hz * mode.damping_ratio;
    const bool matters = mode.amplitude > kFaded * found.mode[0].amplitude;
    if (k == 0 || (matters && decay < slowest)) slowest = decay;
  }
  return kFades / (slowest > kLeastDecay ? slowest : kLeastDecay);
}

bool is_an_end(TuneState state) {
  return state == TuneState::kIdle || state == TuneState::kKept || state == TuneState::kUndone ||
         state == TuneState::kFailed;
}

}  // namespace

void AutoTune::begin(AxisCore& axis, TuneMemory& memory) {
  axis_ = &axis;
  memory_ = &memory;
}

bool AutoTune::busy() const { return step_ != Step::kNone || !is_an_end(report_.state); }

bool AutoTune::at_rest() const { return !axis_->pending() && axis_->state().phase == AxisPhase::kAtRest; }

// --- what is asked of it --------------------------------------------------------------------------------------------

Status AutoTune::start(const TuneConfig& config, Announcement* announced) {
  if (axis_ == nullptr) return refuse(Error::kNotAvailable, Quantity::kNone, 0.0);
  if (busy() || !at_rest()) return busy_now();
  size_t doubles = 0;
  if (axis_->lend_memory(doubles) == nullptr) return refuse(Error::kNotAvailable, Quantity::kNone, 0.0);
  axis_->take_memory_back();
  TunePlan plan{};
  stop_following();
  memory_->claim(MemoryHolder::kTuning);
  const Status status = plan_tuning(*axis_, config, TuneMemory::kSamples, doubles, memory_->bump, plan);
  if (!status.ok()) {
    memory_->release(MemoryHolder::kTuning);
    return status;
  }
  config_ = config;
  plan_ = plan;
  before_ = axis_->shaper();
  verifying_ = is_out_ = shaper_changed_ = handed_over_ = taken_again_ = abort_asked_ = false;
  report_ = TuneReport{};
  report_.state = TuneState::kExciting;
  by_bump_ = config.excitation == TuneExcitation::kBump;
  report_.excited_by = by_bump_ ? TuneExcitation::kBump : TuneExcitation::kMove;
  report_.announced = plan.announced;
  report_.source = config.source;
  store(stopped_, 0);
  step_ = Step::kUnshape;
  if (announced != nullptr) *announced = plan.announced;
  return kOk;
}

void AutoTune::abort() {
  if (!busy()) return;
  abort_asked_ = true;
  stop_listening();
  // What waits is dropped, what moves comes to rest; a shaper that waits takes effect and is then replaced.
  if (axis_->halt(config_.move.limits, nullptr).ok()) return;
  axis_->request_stop();
}

Status AutoTune::accept() {
  if (report_.state != TuneState::kProposed || abort_asked_) return busy_now();
  report_.state = TuneState::kApplying;
  step_ = Step::kApply;
  return kOk;
}

Status AutoTune::undo() {
  const bool may = report_.state == TuneState::kProposed || report_.state == TuneState::kKept;
  if (!may || step_ != Step::kNone || abort_asked_) return busy_now();
  stop_following();
  memory_->claim(MemoryHolder::kTuning);
  end(TuneState::kUndone);
  return kOk;
}

// --- one step after the other ---------------------------------------------------------------------------------------

uint32_t AutoTune::progress_percent() const {
  static constexpr uint32_t kPercent[] = {0, 2, 10, 40, 60, 62, 65, 100, 100, 100};
  const uint32_t reached = kPercent[static_cast<uint32_t>(report_.state)];
  if (step_ != Step::kListen) return reached;
  const uint32_t part = capture_.samples() / (plan_.listen.samples / 25 + 1);
  return capture_.state() == CaptureState::kRunning ? reached + part : reached;
}

void AutoTune::service(const Meanwhile& meanwhile) {
  if (working_ || !busy()) return;
  working_ = true;
  if (abort_asked_ || is_disturbed()) {
    if (step_ != Step::kRestore || ends_as_ != TuneState::kFailed) fail(Finding::kAborted);
    abort_asked_ = false;
  }
  take_step(meanwhile);
  report_.progress_percent = progress_percent();
  if (!busy()) memory_->release(MemoryHolder::kTuning);
  working_ = false;
}

// A stop, or a reset that put the axis where its motion did not lead.
bool AutoTune::is_disturbed() const {
  if (step_ == Step::kRestore) return false;
  if (load(stopped_) != 0 || bump_was_lost()) return true;
  return step_ == Step::kListen && at_rest() && axis_->state().setpoint != expected_;
}

void AutoTune::take_step(const Meanwhile& meanwhile) {
  if (step_ == Step::kListen) return listen();
  if (step_ == Step::kLook) return look(meanwhile);
  if (step_ == Step::kNone || !at_rest()) return;
  if (step_ == Step::kUnshape) return take_off_shaper();
  if (step_ == Step::kMove) return by_bump_ ? send_bump() : send_move();
  if (step_ == Step::kApply) return apply(meanwhile);
  put_back();
}

void AutoTune::take_off_shaper() {
  if (before_.stage_count != 0 && !handed_over_) {
    const Status status = axis_->set_shaper(ShaperDesign{});
    if (!status.ok()) return refused(status);
    handed_over_ = shaper_changed_ = true;
    return;
  }
  handed_over_ = false;
  step_ = Step::kMove;
}

void AutoTune::send_move() {
  Move move = config_.move;
  if (is_out_) {
    move.target_counts = plan_.home_counts;
    if (move.approach != Approach::kShortest)
      move.approach = move.approach == Approach::kPositive ? Approach::kNegative : Approach::kPositive;
  }
  expected_ = is_out_ ? plan_.home : plan_.target;
  Status status = start_listening();
  move.zero_delay = verifying_ && config_.move.zero_delay;
  if (status.ok()) status = axis_->command(move, nullptr);
  // The shaped move may not fit into the time of the plain one.
  if (status.error == Error::kLimitExceeded && move.zero_delay) {
    move.zero_delay = false;
    status = axis_->command(move, nullptr);
  }
  if (!status.ok()) return refused(status);
  is_out_ = !is_out_;
  report_.state = verifying_ ? TuneState::kVerifying : TuneState::kExciting;
  step_ = Step::kListen;
}

// The tick streams it: see there.
void AutoTune::send_bump() {
  Announcement announced{};
  expected_ = axis_->state().setpoint;
  Status status = prepare_bump(*axis_, config_, memory_->bump, announced);
  if (status.ok()) status = start_listening();
  if (!status.ok()) return refused(status);
  memory_->bump.start();
  store(bump_, kBumps);
  StreamConfig stream{config_.move.limits, StreamPolicy::kClamp, kMadeUpTicks};
  status = axis_->begin_stream(stream);
  if (!status.ok()) return refused(status);
  report_.state = verifying_ ? TuneState::kVerifying : TuneState::kExciting;
  step_ = Step::kListen;
}

// A reset may have dropped the stream.
bool AutoTune::bump_was_lost() const { return step_ == Step::kListen && at_rest() && load(bump_) == kBumps; }

void AutoTune::try_bump_or_fail(Finding finding) {
  if (by_bump_ || !plan_.has_bump) return fail(finding);
  by_bump_ = true;
  taken_again_ = false;
  report_.excited_by = TuneExcitation::kBump;
  report_.state = TuneState::kExciting;
  step_ = Step::kMove;
}

Status AutoTune::start_listening() {
  CaptureConfig capture;
  capture.samples = plan_.listen.samples;
  capture.pre_trigger = plan_.listen.pre_trigger;
  capture.decimation = plan_.listen.decimation;
  capture.mean = true;
  store(clipped_, 0);
  const Status status = capture_.start(capture, memory_->record, TuneMemory::kSamples);
  if (!status.ok()) return status;
  watch_.arm(plan_.listen.tolerance, plan_.listen.window_ticks, plan_.listen.patience_ticks);
  store(listens_, 1);
  return kOk;
}

void AutoTune::stop_listening() {
  store(listens_, 0);
  store(bump_, kNoBump);
  watch_.disarm();
  capture_.stop();
}

void AutoTune::listen() {
  if (load(bump_) == kBumpOver) {
    store(bump_, kNoBump);
    if (!axis_->halt(config_.move.limits, nullptr).ok()) axis_->request_stop();
  }
  const CaptureState state = capture_.state();
  if (state == CaptureState::kRunning) {
    if (!verifying_) report_.state = TuneState::kCapturing;
  } else if (state == CaptureState::kFull) {
    store(listens_, 0);
    if (!verifying_) report_.state = TuneState::kIdentifying;
    step_ = Step::kLook;
  }
}

// A power of two of them.
double* AutoTune::borrow(size_t& size) {
  double* const memory = axis_->lend_memory(size);
  while ((size & (size - 1)) != 0) size &= size - 1;
  return memory;
}

bool AutoTune::is_flawed(const CaptureFlaws& flaws) const {
  return flaws.saturated != 0 || flaws.gaps > capture_.samples() * plan_.listen.decimation / kGapsOfTicks;
}

// True where there is no use in looking at it.
bool AutoTune::record_is_flawed() {
  CaptureFlaws flaws = capture_.flaws();
  flaws.saturated = load(clipped_);
  if (!verifying_) report_.flaws = flaws;
  if (!is_flawed(flaws)) return false;
  give_up_record(flaws.saturated != 0 ? Finding::kSaturated : Finding::kNoisy);
  return true;
}

// Another is taken, once. Chance may have put two equal samples on a top, or a gap into a record.
void AutoTune::give_up_record(Finding finding) {
  stop_listening();
  if (!taken_again_) {
    taken_again_ = true;
    step_ = Step::kMove;
  } else if (verifying_) {
    end(TuneState::kUndone);
  } else {
    fail(finding);
  }
}

void AutoTune::look(const Meanwhile& meanwhile) {
  report_.source = load(to_error_) != 0 ? TuneSource::kFollowingError : TuneSource::kAccelerometer;
  if (record_is_flawed()) return;
  size_t size = 0;
  double* const memory = borrow(size);
  if (memory == nullptr) return;
  const Record record = capture_.record(report_.source == TuneSource::kFollowingError ? kCountsPerError : 1.0);
  const IdentifyScratch scratch(memory_->fit, memory, size);
  if (verifying_) {
    look_at_shaped(record, scratch, meanwhile);
  } else {
    look_at_plain(record, scratch, meanwhile);
  }
  axis_->take_memory_back();
  stop_listening();
}

void AutoTune::look_at_plain(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile) {
  Identification& found = report_.identification;
  IdentifyConfig config;
  config.rate_hz = plan_.listen.rate_hz;
  config.least_amplitude = kLeastAmplitude;
  config.ends_known = report_.source == TuneSource::kFollowingError || config_.sensor_lowest < config_.sensor_highest;
  faded_at_ = axis_->state().tick;
  const Status status = identify(record, config, scratch, found, meanwhile);
  if (abort_asked_) return;
  if (!status.ok()) return refused(status);
  if (found.finding == Finding::kSaturated) return give_up_record(found.finding);
  drop_modes_outside_band();
  if (found.finding == Finding::kNoMode || found.finding == Finding::kNoisy) return try_bump_or_fail(found.finding);
  if (found.finding != Finding::kFound) return fail(found.finding);
  const double rest_s = fading_time_s(found) - static_cast<double>(record.count) / config.rate_hz;
  if (rest_s > 0.0) faded_at_ += static_cast<uint32_t>(rest_s / axis_->config().tick_s);
  report_.plain_ringing = ringing(record, scratch, meanwhile).level;
  choose(found, config_.tolerance, axis_->config().tick_s, report_.proposal, meanwhile);
  if (abort_asked_) return;
  report_.source_enough = report_.proposal.residual <= config_.tolerance;
  if (report_.proposal.spec_count == 0 || report_.proposal.residual > kWorthProposing)
    return try_bump_or_fail(Finding::kNoisy);
  report_.state = TuneState::kProposed;
  step_ = Step::kNone;
  if (config_.accept_by_itself) static_cast<void>(accept());
}

Ringing AutoTune::ringing(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile) const {
  return ringing_of(record, plan_.listen.rate_hz, config_.low_hz, config_.high_hz, report_.identification, scratch,
                    meanwhile);
}

void AutoTune::drop_modes_outside_band() {
  Identification& found = report_.identification;
  size_t kept = 0;
  for (size_t k = 0; k < found.mode_count; ++k) {
    const double frequency = found.mode[k].frequency_hz;
    if (frequency >= config_.low_hz && frequency <= config_.high_hz) found.mode[kept++] = found.mode[k];
  }
  if (found.finding != Finding::kFound) return;
  found.mode_count = kept;
  found.confidence = kept == 0 ? 0.0 : found.mode[0].confidence;
  if (kept == 0) found.finding = Finding::kNoMode;
}

void AutoTune::look_at_shaped(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile) {
  report_.shaped_ringing = ringing(record, scratch, meanwhile).at_most;
  if (abort_asked_) return;
  if (!(report_.shaped_ringing <= kClearlyBetter * report_.plain_ringing)) return end(TuneState::kUndone);
  report_.state = TuneState::kKept;
  step_ = Step::kNone;
}

void AutoTune::apply(const Meanwhile& meanwhile) {
  if (!handed_over_) {
    ShaperDesign design{};
    Status status = design_of(report_.proposal, axis_->config().tick_s, design, meanwhile);
    if (abort_asked_) return;
    if (status.ok()) status = axis_->set_shaper(design);
    if (!status.ok()) return refused(status);
    handed_over_ = shaper_changed_ = true;
    return;
  }
  if (static_cast<int32_t>(axis_->state().tick - faded_at_) < 0) return;
  handed_over_ = false;
  verifying_ = true;
  taken_again_ = false;
  step_ = Step::kMove;
}

// --- where it ends --------------------------------------------------------------------------------------------------

void AutoTune::put_back() {
  if (shaper_changed_ && !handed_over_) {
    handed_over_ = axis_->set_shaper(before_).ok();
    return;
  }
  shaper_changed_ = handed_over_ = false;
  report_.state = ends_as_;
  step_ = Step::kNone;
}

// The shaper of before comes first.
void AutoTune::end(TuneState state) {
  stop_listening();
  ends_as_ = state;
  handed_over_ = false;
  report_.state = TuneState::kApplying;
  step_ = Step::kRestore;
}

void AutoTune::fail(Finding finding) {
  Identification& found = report_.identification;
  found.finding = finding;
  found.mode_count = 0;
  found.confidence = 0.0;
  end(TuneState::kFailed);
}

void AutoTune::refused(const Status& status) {
  report_.refusal = status;
  fail(Finding::kAborted);
}

// --- tick -----------------------------------------------------------------------------------------------------------

// Which sensor is known once the motion has shaken it.
void AutoTune::choose_source() {
  const bool to_error =
      config_.source == TuneSource::kFollowingError || (config_.source == TuneSource::kAuto && load(accelerates_) == 0);
  store(to_error_, to_error ? 1 : 0);
}

int32_t AutoTune::value_of(const TuneSample& sample) {
  const bool to_error = load(to_error_) != 0;
  const int32_t lowest = to_error ? INT32_MIN : config_.sensor_lowest;
  const int32_t highest = to_error ? INT32_MAX : config_.sensor_highest;
  int32_t value = sample.acceleration;
  if (to_error) {
    const Signal error =
        wrapping_difference(sample.position, sample.setpoint) >> (kSignalFractionBits - kErrorFractionBits);
    value = error > INT32_MAX ? INT32_MAX : error < INT32_MIN ? INT32_MIN : static_cast<int32_t>(error);
  }
  if (lowest < highest && sample.fresh && (value <= lowest || value >= highest)) store(clipped_, clipped_ + 1);
  return value;
}

void AutoTune::tick(const TuneSample& sample) {
  if (sample.fresh && !has_first_) {
    has_first_ = true;
    first_ = sample.acceleration;
  } else if (sample.fresh && sample.acceleration != first_) {
    store(accelerates_, 1);
  }
  if (axis_ == nullptr) return;
  const AxisPhase phase = axis_->state().phase;
  if (phase == AxisPhase::kStopping) store(stopped_, 1);
  if (load(listens_) == 0 || memory_->held_by(MemoryHolder::kScope)) return;
  if (phase == AxisPhase::kStreaming && load(bump_) == kBumps) {
    const Signal offset = memory_->bump.tick();
    axis_->stream(plan_.bump_forward ? expected_ + offset : expected_ - offset);
    if (memory_->bump.over()) store(bump_, kBumpOver);
  }
  if (phase != AxisPhase::kAtRest) capture_.finish();
  if (capture_.state() == CaptureState::kFull) return;
  if (watch_.tick(phase == AxisPhase::kAtRest, sample.position, sample.fresh)) capture_.trigger();
  // Not while it moves: a gap or a value at the sensor's end is no flaw of the record then.
  if (!watch_.is_after_motion()) return choose_source();
  const int32_t value = value_of(sample);
  capture_.tick(&value, sample.fresh);
}

}  // namespace stillpoint
