// SPDX-License-Identifier: Apache-2.0
#include "firmware/mode_tracking.hpp"

#include "firmware/register_units.hpp"

namespace stillpoint::firmware {
namespace {

constexpr double kFrequencyPerHz = 1e4;
constexpr double kDampingPerOne = 1e5;
constexpr double kResidualPerOne = 1e4;
// Of the band that is listened to, about the modes that are followed. The low end makes the record long enough.
constexpr double kBandLow = 0.5;
constexpr double kBandHigh = 1.2;
constexpr double kLeastPeriods = 4.0;  // of the slowest mode, in a record

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
  if (state == CaptureState::kFull) look(meanwhile);
}

void ModeTracking::begin_anew() {
  begun_ = true;
  changes_ = parts_.shaper->changes();
  Mode modes[kMaxModes];
  tracker_.begin(modes, parts_.shaper->modes_in_force(modes));
  tracker_.enable(true);
  parts_.parameters->set(Register::kTrackingUsed, 0);
  parts_.parameters->set(Register::kTrackingUnheard, 0);
  show();
  parts_.tuner->stop_following();
}

void ModeTracking::listen() {
  double low_hz = tracker_.mode(0).frequency_hz;
  double high_hz = low_hz;
  for (size_t k = 1; k < tracker_.count(); ++k) {
    const double frequency = tracker_.mode(k).frequency_hz;
    low_hz = math::lesser(low_hz, frequency);
    high_hz = math::greater(high_hz, frequency);
  }
  ListenPlan plan = {};
  const double tick_s = parts_.axis->config().tick_s;
  if (tracker_.count() == 0 || !plan_listening(kBandLow * low_hz, kBandHigh * high_hz, tick_s, kSamples, plan).ok())
    return;
  const Parameters& parameters = *parts_.parameters;
  plan.tolerance = signal_from_counts(parameters.get_signed(Register::kPositionWindow));
  least_ = static_cast<uint32_t>(kLeastPeriods * plan.rate_hz / low_hz);
  parts_.tuner->follow(static_cast<TuneSource>(parameters.get(Register::kTuneSourceWanted)),
                       parameters.get_signed(Register::kTuneSensorLowest),
                       parameters.get_signed(Register::kTuneSensorHighest), plan);
}

void ModeTracking::look(const Meanwhile& meanwhile) {
  given_up_ = false;
  const Identification found =
      parts_.tuner->look_at_followed(least_, Meanwhile{meanwhile.run, meanwhile.context, &given_up_});
  if (found.finding == Finding::kAborted) return;
  const size_t left_out = tracker_.left_out();
  const bool moved = tracker_.follow(found);
  const Register what = moved ? Register::kTrackingUsed : Register::kTrackingUnheard;
  Parameters& parameters = *parts_.parameters;
  if (moved || tracker_.left_out() == left_out) parameters.set(what, parameters.get(what) + 1);
  show();
  listen();
  if (!moved || wanted() != Tracking::kApply || parameters.get(Register::kTrackingRefusal) != 0) return;
  Mode modes[kMaxModes];
  for (size_t k = 0; k < tracker_.count(); ++k) modes[k] = tracker_.mode(k);
  parts_.shaper->follow(modes, kWorthwhile * parameters.get(Register::kTuneTolerance) / kResidualPerOne);
}

void ModeTracking::show() {
  Parameters& parameters = *parts_.parameters;
  parameters.set(Register::kTrackingLeftOut, static_cast<uint32_t>(tracker_.left_out()));
  for (uint32_t k = 0; k < kMaxModes; ++k) {
    const Mode mode = k < tracker_.count() ? tracker_.mode(k) : Mode{};
    parameters.set(tracked_register(k, 0), register_nearest(mode.frequency_hz, kFrequencyPerHz));
    parameters.set(tracked_register(k, kTrackedDamping), register_nearest(mode.damping_ratio, kDampingPerOne));
  }
}

}  // namespace stillpoint::firmware
