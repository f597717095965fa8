// SPDX-License-Identifier: Apache-2.0
// What was recorded or heard, and what follows from it.
#include "shaper/base/math.hpp"
#include "shaper/base/shared.hpp"
#include "shaper/tune/auto_tune.hpp"
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
constexpr double kAnswerTicks = 2.0;                     // from the excitation to the sensor, at first

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

}  // namespace

// A power of two of them.
double* AutoTune::borrow(size_t& size) {
  double* const memory = axis_->lend_memory(size);
  while ((size & (size - 1)) != 0) size &= size - 1;
  return memory;
}

// kFound where they do not matter to what took so many ticks.
Finding AutoTune::flaw_of(const CaptureFlaws& flaws, uint32_t ticks) {
  if (flaws.saturated != 0) return Finding::kSaturated;
  return flaws.gaps > ticks / kGapsOfTicks ? Finding::kNoisy : Finding::kFound;
}

CaptureFlaws AutoTune::recorded_flaws() const {
  CaptureFlaws flaws = capture_.flaws();
  flaws.saturated = load(clipped_);
  return flaws;
}

// The following error has none.
bool AutoTune::ends_known() const { return load(to_error_) != 0 || config_.sensor_lowest < config_.sensor_highest; }

// True where there is no use in looking at it.
bool AutoTune::record_is_flawed() {
  const CaptureFlaws flaws = recorded_flaws();
  if (!verifying_) report_.flaws = flaws;
  const Finding flaw = flaw_of(flaws, recorded_ticks());
  if (flaw == Finding::kFound) return false;
  give_up_record(flaw);
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
  if (load(hears_) != kRecords) return look_at_answers(meanwhile);
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

Status AutoTune::identify_answers(const Meanwhile& meanwhile) {
  SineMemory& memory = memory_->sine;
  Identification& found = report_.identification;
  const double tick_s = axis_->config().tick_s;
  const bool to_error = report_.source == TuneSource::kFollowingError;
  const ResponseConfig config{to_error ? 0U : 2U, kAnswerTicks * tick_s, kMostResponseModes};
  if (by_ == TuneExcitation::kSteppedSine)
    return identify_stepped(memory.bins, memory.excitation, tick_s, config, memory.answers, memory.scratch, found,
                            meanwhile);
  const uint32_t count = memory.chirp.answers(memory.excitation, tick_s, memory.answers, meanwhile);
  return identify_response(memory.answers, count, config, memory.scratch, found, meanwhile);
}

// Another sine would take as long and tell no more.
void AutoTune::look_at_answers(const Meanwhile& meanwhile) {
  Identification& found = report_.identification;
  report_.flaws = CaptureFlaws{load(gaps_), load(clipped_), 0};
  stop_listening();
  const Finding flaw = flaw_of(report_.flaws, memory_->excitation.ticks());
  if (flaw != Finding::kFound) return fail(flaw);
  const Status status = identify_answers(meanwhile);
  if (abort_asked_) return;
  if (!status.ok()) return refused(status);
  drop_modes_outside_band();
  if (found.finding != Finding::kFound) return fail(found.finding);
  answered_ = true;
  taken_again_ = false;
  by_ = TuneExcitation::kBump;
  report_.state = TuneState::kExciting;
  step_ = Step::kMove;
}

void AutoTune::look_at_plain(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile) {
  Identification& found = report_.identification;
  IdentifyConfig config;
  config.rate_hz = plan_.listen.rate_hz;
  config.least_amplitude = kLeastAmplitude;
  config.ends_known = ends_known();
  faded_at_ = axis_->state().tick;
  Status status = kOk;
  if (answered_) {
    fit_modes(record, scratch, meanwhile);
  } else {
    status = identify(record, config, scratch, found, meanwhile);
  }
  if (abort_asked_) return;
  if (!status.ok()) return refused(status);
  if (found.finding == Finding::kSaturated) return give_up_record(found.finding);
  drop_modes_outside_band();
  if (found.finding == Finding::kNoMode || found.finding == Finding::kNoisy)
    return try_next_or_fail(found.finding, meanwhile);
  if (found.finding != Finding::kFound) return fail(found.finding);
  const double rest_s = fading_time_s(found) - static_cast<double>(record.count) / config.rate_hz;
  if (rest_s > 0.0) faded_at_ += static_cast<uint32_t>(rest_s / axis_->config().tick_s);
  report_.plain_ringing = ringing(record, scratch, meanwhile).level;
  choose(found, config_.tolerance, axis_->config().tick_s, report_.proposal, meanwhile);
  if (abort_asked_) return;
  report_.source_enough = report_.proposal.residual <= config_.tolerance;
  if (report_.proposal.spec_count == 0 || report_.proposal.residual > kWorthProposing)
    return try_next_or_fail(Finding::kNoisy, meanwhile);
  report_.state = TuneState::kProposed;
  step_ = Step::kNone;
  if (config_.accept_by_itself) static_cast<void>(accept());
}

// What a sine has answered has no record: amplitudes and noise come from the one that is compared.
void AutoTune::fit_modes(const Record& record, const IdentifyScratch& scratch, const Meanwhile& meanwhile) {
  Identification& found = report_.identification;
  const auto count = static_cast<double>(record.count);
  found.model = DecayModel{};
  for (size_t k = 0; k < found.mode_count; ++k) {
    const IdentifiedMode& mode = found.mode[k];
    const double angle = 2.0 * math::kPi * mode.frequency_hz * count / plan_.listen.rate_hz;
    Component& component = found.model.component[found.model.count++];
    component.decay = angle * mode.damping_ratio;
    component.angle = angle * math::sqrt(1.0 - math::square(mode.damping_ratio));
  }
  scratch.fit.solve_linear(record, found.model, nullptr, meanwhile);
  found.noise = math::sqrt(scratch.fit.residual_energy() / (count - 2.0 - 2.0 * static_cast<double>(found.mode_count)));
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

}  // namespace stillpoint
