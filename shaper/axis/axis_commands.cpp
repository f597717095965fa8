// SPDX-License-Identifier: Apache-2.0
// The background's side of the axis: what is asked of it, checked and prepared.
#include "shaper/axis/axis_core.hpp"
#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

Status check_duration(const Move& move, double tick_s) {
  return check_range(Quantity::kDuration, move.duration_s, 0.0, kMaxDurationTicks * tick_s);
}

}  // namespace

Status AxisCore::check_ready() const {
  if (!configured_) return refuse(Error::kNotAvailable);
  if (pending() || state().phase != AxisPhase::kAtRest) return refuse(Error::kBusy);
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
  turns_.configure(config.modulo_counts);
  soft_low_ = signal_from_counts(config.soft_low_counts);
  soft_high_ = signal_from_counts(config.soft_high_counts);
  configured_ = true;
  return kOk;
}

Status AxisCore::check_move(const Move& move) const {
  if (!configured_) return refuse(Error::kNotAvailable);
  Status status = move.limits.validate();
  if (status.ok()) status = move.limits.within(config_.maximum);
  if (status.ok()) status = check_duration(move, config_.tick_s);
  return status;
}

// Where the target lies, and whether it may be gone to from there.
Status AxisCore::find_target(const Move& move, const Differences& start, Signal zero, Signal& target) const {
  const int32_t counts = move.target_counts;
  if (config_.modulo_counts != 0) {
    const auto turn = static_cast<int32_t>(config_.modulo_counts);
    if (counts < 0) return refuse(Error::kBelowMinimum, Quantity::kPosition, counts, 0.0);
    if (counts >= turn) return refuse(Error::kAboveMaximum, Quantity::kPosition, counts, turn - 1.0);
    const Signal from = signal_of(start);
    const Turns turns{turns_.counts, turns_.step, zero};
    target = wrapping_sum(from, turns.distance(from, signal_from_counts(counts), move.approach));
    return kOk;
  }
  if (config_.has_soft_limits()) {
    if (counts < config_.soft_low_counts)
      return refuse(Error::kBelowMinimum, Quantity::kPosition, counts, config_.soft_low_counts);
    if (counts > config_.soft_high_counts)
      return refuse(Error::kAboveMaximum, Quantity::kPosition, counts, config_.soft_high_counts);
  }
  constexpr double kLongest = kMaxPositionCounts;
  const double distance = counts - to_double(start.difference[0], kTrackFractionBits);
  if (math::magnitude(distance) > kLongest)
    return refuse(Error::kAboveMaximum, Quantity::kDistance, distance, kLongest);
  target = signal_from_counts(counts);
  return kOk;
}

Status AxisCore::plan_at_rest(const Move& move, const AxisState& now, Signal& target, Plan& plan) const {
  const Signal start = now.setpoint;
  const Status status = find_target(move, standing(start), now.zero, target);
  if (!status.ok()) return status;
  const double distance =
      to_double(Wide{0, static_cast<uint64_t>(wrapping_difference(target, start))}, kTrackFractionBits);
  return plan_rest_to_rest(distance, move.limits, move.kind, config_.tick_s, plan, move.detail);
}

Status AxisCore::preview(const Move& move, Signal& target, MoveReport& report) {
  Status status = check_ready();
  if (status.ok()) status = check_move(move);
  if (!status.ok()) return status;
  const AxisState now = state();
  Plan plan{};
  status = plan_at_rest(move, now, target, plan);
  report = MoveReport{};
  report.optimum_ticks = plan.optimum_ticks;
  if (status.ok()) status = time_plainly(move, now.setpoint, target, plan, report);
  report.profile_ticks = plan.duration_ticks;
  report.total_ticks = plan.duration_ticks;
  return status;
}

Status AxisCore::command(const Move& move, MoveReport* report) {
  const uint32_t epoch = load(epoch_);
  const AxisState now = state();
  Status status = check_move(move);
  if (!status.ok()) return status;
  if (pending()) return refuse(Error::kBusy);
  if (now.phase != AxisPhase::kAtRest) return command_in_flight(move, report);
  const Signal start = now.setpoint;
  Signal target = start;
  Plan plan{};
  status = plan_at_rest(move, now, target, plan);
  const uint32_t least_ticks = plan.duration_ticks;
  MoveReport result{0, 0, plan.optimum_ticks, false};
  if (status.ok()) status = time_move(move, start, target, plan, result);
  if (!status.ok()) return status;
  Track::make(plan, start, target, tracks_[active_track_ ^ 1]);
  const bool moves = plan.distance != 0.0;
  result.profile_ticks = plan.duration_ticks;
  result.total_ticks = plan.duration_ticks + (moves ? running().length_ticks() : 0);
  if (report != nullptr) *report = result;
  const bool only_checked = plan.duration_ticks < least_ticks || result.timing == MoveTiming::kRaised;
  terms_[active_track_ ^ 1] = Terms{move, only_checked, false, 0.0, 0};
  hand_over_move(kFromRest, epoch);
  return kOk;
}

}  // namespace stillpoint
