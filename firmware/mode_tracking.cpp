// SPDX-License-Identifier: Apache-2.0
#include "firmware/mode_tracking.hpp"

#include "firmware/register_units.hpp"

namespace stillpoint::firmware {
namespace {

// Of the band that is listened to, half the lowest frequency followed and 1.2 times the highest, as the registers have
// them. The low end makes the record long enough.
constexpr double kBandLow = 2e4;
constexpr double kBandHigh = 1e4 / 1.2;
constexpr double kLeast = 4e4;  // of the slowest mode, in a record: four periods

}  // namespace

bool ModeTracking::is_in_the_way() const {
  return parts_.axis->pending() || parts_.drive->is_asked() || parts_.shaper->waiting() || parts_.tuning->busy();
}

void ModeTracking::keep_watch(bool busy) {
  if (parts_.axis == nullptr) return;
  given_up_ = given_up_ || busy || is_in_the_way() || wanted() == Tracking::kOff ||
              parts_.tuner->following() != CaptureState::kFull;
}

void ModeTracking::service(const Meanwhile& meanwhile) {
  if (parts_.axis == nullptr || is_in_the_way()) return;
  if (wanted() == Tracking::kOff || !parts_.drive->may_move()) {
    begun_ = begun_ && wanted() != Tracking::kOff;
    return parts_.tuner->stop_following();
  }
  if (!begun_ || changes_ != parts_.shaper->changes()) begin_anew();
  const CaptureState state = parts_.tuner->following();
  if (state == CaptureState::kIdle) listen();
  // A halt must find the memory that a look borrows, where it needs it.
  const bool rests = parts_.axis->state().phase == AxisPhase::kAtRest;
  if (state == CaptureState::kFull && (rests || !parts_.axis->flight_needs_memory())) look(meanwhile);
  // A design keeps the background from whoever drives.
  if (rests) apply();
}

void ModeTracking::begin_anew() {
  begun_ = true;
  moved_ = false;
  changes_ = parts_.shaper->changes();
  Mode modes[kMaxModes];
  tracker_.begin(modes, parts_.shaper->modes_in_force(modes));
  tracker_.enable(true);
  parts_.parameters->set(Register::kTrackingRefusal, 0);
  parts_.parameters->set(Register::kTrackingUsed, 0);
  parts_.parameters->set(Register::kTrackingUnheard, 0);
  show();
  parts_.tuner->stop_following();
}

void ModeTracking::listen() {
  const Parameters& parameters = *parts_.parameters;
  uint32_t low = parameters.get(Register::kFirstTrackedMode);
  uint32_t high = low;
  for (uint32_t k = 1; k < tracker_.count(); ++k) {
    const uint32_t frequency = parameters.get(tracked_register(k, 0));
    if (frequency < low) low = frequency;
    if (frequency > high) high = frequency;
  }
  ListenPlan plan = {};
  const double tick_s = parts_.axis->config().tick_s;
  // Without a mode the lowest is 0 and refused.
  if (!plan_listening(low / kBandLow, high / kBandHigh, tick_s, kSamples, plan).ok()) return;
  plan.tolerance = signal_from_counts(parameters.get_signed(Register::kPositionWindow));
  least_ = static_cast<uint32_t>(plan.rate_hz * kLeast) / low;
  parts_.tuner->follow(static_cast<TuneSource>(parameters.get(Register::kTuneSourceWanted)),
                       parameters.get_signed(Register::kTuneSensorLowest),
                       parameters.get_signed(Register::kTuneSensorHighest), plan);
}

void ModeTracking::look(const Meanwhile& meanwhile) {
  given_up_ = false;
  const Identification found =
      parts_.tuner->look_at_followed(least_, Meanwhile{meanwhile.run, meanwhile.context, &given_up_});
  keep_watch(false);
  if (found.finding == Finding::kAborted || given_up_) return;
  const size_t left_out = tracker_.left_out();
  const bool moved = tracker_.follow(found);
  const Register what = moved ? Register::kTrackingUsed : Register::kTrackingUnheard;
  Parameters& parameters = *parts_.parameters;
  if (moved || tracker_.left_out() == left_out) parameters.set(what, parameters.get(what) + 1);
  show();
  listen();
  moved_ = moved_ || moved;
}

void ModeTracking::apply() {
  const Parameters& parameters = *parts_.parameters;
  if (!moved_ || wanted() != Tracking::kApply || parameters.get(Register::kTrackingRefusal) != 0) return;
  if (is_in_the_way()) return;
  moved_ = false;
  parts_.shaper->follow(kWorthwhile * parameters.get(Register::kTuneTolerance) / kResidualPerOne);
}

void ModeTracking::show() {
  Parameters& parameters = *parts_.parameters;
  parameters.set(Register::kTrackingLeftOut, static_cast<uint32_t>(tracker_.left_out()));
  for (uint32_t k = 0; k < kMaxModes; ++k) {
    const bool followed = k < tracker_.count();
    const float hz = followed ? tracker_.frequency_hz(k) : 0.0F;
    const float damping = followed ? tracker_.damping_ratio(k) : 0.0F;
    parameters.set(tracked_register(k, 0), static_cast<uint32_t>(hz * static_cast<float>(kFrequencyPerHz) + 0.5F));
    parameters.set(tracked_register(k, kTrackedDamping),
                   static_cast<uint32_t>(damping * static_cast<float>(kDampingPerOne) + 0.5F));
  }
}

}  // namespace stillpoint::firmware
