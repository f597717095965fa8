// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/auto_tune.hpp"

#include "shaper/base/shared.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kMadeUpTicks = 4;  // of the stream that excites; the tick misses none

Status busy_now() { return refuse(Error::kBusy); }

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
  if (axis_ == nullptr) return refuse(Error::kNotAvailable);
  if (busy() || !at_rest()) return busy_now();
  size_t doubles = 0;
  if (axis_->lend_memory(doubles) == nullptr) return refuse(Error::kNotAvailable);
  axis_->take_memory_back();
  TunePlan plan{};
  stop_following();
  memory_->claim(MemoryHolder::kTuning);
  const Status status = plan_tuning(*axis_, config, TuneMemory::kSamples, doubles, memory_->excitation, plan);
  if (!status.ok()) {
    memory_->release(MemoryHolder::kTuning);
    return status;
  }
  config_ = config;
  plan_ = plan;
  before_ = axis_->shaper();
  verifying_ = is_out_ = shaper_changed_ = handed_over_ = taken_again_ = abort_asked_ = answered_ = false;
  report_ = TuneReport{};
  report_.state = TuneState::kExciting;
  by_ = config.excitation == TuneExcitation::kAuto ? TuneExcitation::kMove : config.excitation;
  report_.excited_by = by_;
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
  if (answered_ && reached < 40) return 50;
  if (step_ != Step::kListen) return reached;
  const SineMemory& sine = memory_->sine;
  if (load(hears_) == kHearsChirp) return reached + 38 * sine.chirp.progress_percent() / 100;
  if (load(hears_) == kHearsSine) return reached + 38 * sine.excitation.step() / sine.excitation.steps();
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
  if (load(stopped_) != 0 || stream_was_lost()) return true;
  return step_ == Step::kListen && at_rest() && axis_->state().setpoint != expected_;
}

void AutoTune::take_step(const Meanwhile& meanwhile) {
  if (step_ == Step::kListen) return listen();
  if (step_ == Step::kLook) return look(meanwhile);
  if (step_ == Step::kNone || !at_rest()) return;
  if (step_ == Step::kUnshape) return take_off_shaper();
  if (step_ == Step::kMove) return by_ == TuneExcitation::kMove ? send_move() : send_stream();
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
void AutoTune::send_stream() {
  expected_ = axis_->state().setpoint;
  Status status = kOk;
  if (by_ == TuneExcitation::kBump) {
    Announcement announced{};
    status = prepare_bump(*axis_, config_, memory_->excitation, announced);
    if (status.ok()) status = start_listening();
  } else {
    start_hearing();
  }
  if (!status.ok()) return refused(status);
  memory_->excitation.start();
  store(stream_, kStreams);
  StreamConfig stream{config_.move.limits, StreamPolicy::kClamp, kMadeUpTicks};
  status = axis_->begin_stream(stream);
  if (!status.ok()) return refused(status);
  report_.state = verifying_ ? TuneState::kVerifying : TuneState::kExciting;
  step_ = Step::kListen;
}

// A reset may have dropped the stream.
bool AutoTune::stream_was_lost() const { return step_ == Step::kListen && at_rest() && load(stream_) == kStreams; }

void AutoTune::try_next_or_fail(Finding finding, const Meanwhile& meanwhile) {
  if (answered_ || !plan_.has_bump) return fail(finding);
  if (by_ == TuneExcitation::kMove) {
    by_ = TuneExcitation::kBump;
  } else if (config_.excitation == TuneExcitation::kAuto &&
             prepare_sine(*axis_, config_, plan_, memory_->excitation, report_.announced, meanwhile).ok()) {
    by_ = TuneExcitation::kSteppedSine;
  } else {
    return fail(finding);
  }
  taken_again_ = false;
  report_.excited_by = by_;
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
  return status;
}

void AutoTune::start_hearing() {
  const bool is_chirp = by_ == TuneExcitation::kChirp;
  const double tick_s = axis_->config().tick_s;
  if (is_chirp) {
    memory_->sine.chirp.start(memory_->excitation, config_.low_hz * tick_s, config_.high_hz * tick_s);
  } else {
    memory_->sine.bins.start();
  }
  store(clipped_, 0);
  store(gaps_, 0);
  store(hears_, is_chirp ? kHearsChirp : kHearsSine);
  store(listens_, 1);
}

void AutoTune::stop_listening() {
  store(listens_, 0);
  store(hears_, kRecords);
  store(stream_, kNoStream);
  watch_.disarm();
  capture_.stop();
}

void AutoTune::listen() {
  if (load(stream_) == kStreamOver) {
    store(stream_, kNoStream);
    if (!axis_->halt(config_.move.limits, nullptr).ok()) axis_->request_stop();
  }
  const CaptureState state = capture_.state();
  if (load(hears_) != kRecords) {
    if (!at_rest()) return;
    report_.state = TuneState::kIdentifying;
    step_ = Step::kLook;
  } else if (state == CaptureState::kRunning) {
    if (!verifying_) report_.state = TuneState::kCapturing;
  } else if (state == CaptureState::kFull) {
    store(listens_, 0);
    if (!verifying_) report_.state = TuneState::kIdentifying;
    step_ = Step::kLook;
  }
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

}  // namespace stillpoint
