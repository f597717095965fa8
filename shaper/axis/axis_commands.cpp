// SPDX-License-Identifier: Apache-2.0
// The background's side of the axis: what is asked of it, checked and prepared.
#include "shaper/axis/axis_core.hpp"
#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

// Counts from one signal to another; each fits, their difference may not.
double distance_counts(Signal from, Signal to) {
  const int64_t whole = (to >> kSignalFractionBits) - (from >> kSignalFractionBits);
  const int64_t fraction = (to & (kSignalPerCount - 1)) - (from & (kSignalPerCount - 1));
  return static_cast<double>(whole) + static_cast<double>(fraction) / static_cast<double>(kSignalPerCount);
}

Status check_duration(const Move& move, double tick_s) {
  if (!math::is_finite(move.duration_s)) return refuse(Error::kNotFinite, Quantity::kDuration, move.duration_s);
  if (move.duration_s < 0.0) return refuse(Error::kBelowMinimum, Quantity::kDuration, move.duration_s, 0.0);
  const double longest = kMaxDurationTicks * tick_s;
  if (move.duration_s > longest) return refuse(Error::kAboveMaximum, Quantity::kDuration, move.duration_s, longest);
  return kOk;
}

Status check_distance(double distance) {
  constexpr double kLongest = kMaxPositionCounts;
  if (math::abs(distance) > kLongest) return refuse(Error::kAboveMaximum, Quantity::kDistance, distance, kLongest);
  return kOk;
}

}  // namespace

Status AxisCore::check_ready() const {
  if (!configured_) return refuse(Error::kNotAvailable, Quantity::kNone, 0.0);
  if (pending() || state().phase != AxisPhase::kAtRest) return refuse(Error::kBusy, Quantity::kNone, 0.0);
  return kOk;
}

Status AxisCore::configure(const AxisConfig& config) {
  Status status = config.validate();
  if (!status.ok()) return status;
  if (configured_) status = check_ready();
  if (!status.ok()) return status;
  if (running().stage_count() != 0 && config.tick_s != config_.tick_s)
    return refuse(Error::kNotAvailable, Quantity::kTick, config.tick_s, config_.tick_s);
  status = StopLimits::make(config.quick_stop_deceleration, config.quick_stop_jerk, config.tick_s, stop_limits_);
  if (!status.ok()) return status;
  config_ = config;
  configured_ = true;
  return kOk;
}

Status AxisCore::command(const Move& move, MoveReport* report) {
  const uint32_t epoch = load(epoch_);
  const Signal start = state().setpoint;
  Status status = check_ready();
  if (status.ok()) status = move.limits.validate();
  if (status.ok()) status = move.limits.within(config_.maximum);
  if (status.ok()) status = check_duration(move, config_.tick_s);
  if (!status.ok()) return status;
  const Signal target = signal_from_counts(move.target_counts);
  const double distance = distance_counts(start, target);
  status = check_distance(distance);
  Plan plan{};
  if (status.ok()) status = plan_rest_to_rest(distance, move.limits, move.kind, config_.tick_s, plan);
  const uint32_t least_ticks = plan.duration_ticks;
  MoveReport result{0, 0, plan.optimum_ticks, false};
  if (status.ok()) status = time_move(move, start, plan, result);
  if (!status.ok()) return status;
  Track::make(plan, start, target, tracks_[active_track_ ^ 1]);
  result.profile_ticks = plan.duration_ticks;
  result.total_ticks = plan.duration_ticks + (distance != 0.0 ? running().length_ticks() : 0);
  if (report != nullptr) *report = result;
  move_ = move;
  move_sped_up_ = plan.duration_ticks < least_ticks || result.timing == MoveTiming::kRaised;
  hand_over(kMove, epoch);
  return kOk;
}

}  // namespace stillpoint
