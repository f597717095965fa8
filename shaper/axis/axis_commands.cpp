// SPDX-License-Identifier: Apache-2.0
// The background's side of the axis: what is asked of it, checked and prepared.
#include "shaper/axis/axis_core.hpp"
#include "shaper/axis/zero_delay.hpp"
#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

Status check_duration(const Move& move, double tick_s) {
  if (!math::is_finite(move.duration_s)) return refuse(Error::kNotFinite, Quantity::kDuration, move.duration_s);
  if (move.duration_s < 0.0) return refuse(Error::kBelowMinimum, Quantity::kDuration, move.duration_s, 0.0);
  const double longest = kMaxDurationTicks * tick_s;
  if (move.duration_s > longest) return refuse(Error::kAboveMaximum, Quantity::kDuration, move.duration_s, longest);
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
  turns_.configure(config.modulo_counts);
  soft_low_ = signal_from_counts(config.soft_low_counts);
  soft_high_ = signal_from_counts(config.soft_high_counts);
  configured_ = true;
  return kOk;
}

Status AxisCore::check_move(const Move& move) const {
  if (!configured_) return refuse(Error::kNotAvailable, Quantity::kNone, 0.0);
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
  if (math::abs(distance) > kLongest) return refuse(Error::kAboveMaximum, Quantity::kDistance, distance, kLongest);
  target = signal_from_counts(counts);
  return kOk;
}

Status AxisCore::command(const Move& move, MoveReport* report) {
  const uint32_t epoch = load(epoch_);
  const AxisState now = state();
  Status status = check_move(move);
  if (!status.ok()) return status;
  if (pending()) return refuse(Error::kBusy, Quantity::kNone, 0.0);
  if (now.phase != AxisPhase::kAtRest) return command_in_flight(move, report);
  const Signal start = now.setpoint;
  Signal target = start;
  status = find_target(move, standing(start), now.zero, target);
  if (!status.ok()) return status;
  const double distance =
      to_double(Wide{0, static_cast<uint64_t>(wrapping_difference(target, start))}, kTrackFractionBits);
  Plan plan{};
  status = plan_rest_to_rest(distance, move.limits, move.kind, config_.tick_s, plan, move.detail);
  const uint32_t least_ticks = plan.duration_ticks;
  if (status.ok() && !running().averages()) status = slow_down_for_shaper(move, start, target, plan);
  MoveReport result{0, 0, plan.optimum_ticks, false};
  if (status.ok()) {
    status = move.zero_delay ? time_zero_delay(move, start, target, plan, result) : time_plainly(move, plan, result);
  }
  if (!status.ok()) return status;
  Track::make(plan, start, target, tracks_[active_track_ ^ 1]);
  result.profile_ticks = plan.duration_ticks;
  result.total_ticks = plan.duration_ticks + (distance != 0.0 ? running().length_ticks() : 0);
  if (report != nullptr) *report = result;
  terms_[active_track_ ^ 1] = Terms{move, plan.duration_ticks < least_ticks, false, 0.0, 0};
  hand_over_move(kFromRest, epoch);
  return kOk;
}

// Negative gains may raise peaks. Slowed down by the factor k, the first three differences stay within G v / k,
// G a / k^2 and G j / k^3 of either sign, G the peak gain: so k = max(G, sqrt(G r)), r the larger of the accelerations
// over the smaller, is certainly enough. Moves short enough to be looked at are slowed down no more than they need.
Status AxisCore::slow_down_for_shaper(const Move& move, Signal start, Signal target, Plan& plan) {
  if (plan.distance == 0.0) return kOk;
  const uint32_t spare = active_shaper_ ^ 1;
  const Status status = shapers_[spare].configure(running(), memory_[spare], capacity_, start);
  if (!status.ok()) return status;
  const AxisLimits& limits = move.limits;
  const double gain = shaper().peak_gain();
  const double ratio = limits.acceleration / limits.deceleration;
  const double by_acceleration = math::sqrt(gain * (ratio > 1.0 ? ratio : 1.0 / ratio));
  const double enough = math::ceil(plan.duration_ticks * (by_acceleration > gain ? by_acceleration : gain));
  if (enough > kMaxDurationTicks)
    return refuse(Error::kAboveMaximum, Quantity::kDuration, enough * config_.tick_s,
                  kMaxDurationTicks * config_.tick_s);
  uint32_t ticks = static_cast<uint32_t>(enough);
  if (plan.duration_ticks <= kLongestSearchTicks) {
    ShapedMoveCheck check(plan, limits, move.jerk_limited(), config_.tick_s, shapers_[spare],
                          tracks_[active_track_ ^ 1], start, target);
    ticks = check.least_slowed_ticks(plan.duration_ticks, ticks);
  }
  return stretch(plan, ticks);
}

Status AxisCore::time_plainly(const Move& move, Plan& plan, MoveReport& report) const {
  if (move.duration_s != 0.0) {
    const double ticks = math::floor(move.duration_s / config_.tick_s + 0.5);
    if (ticks < plan.duration_ticks)
      return refuse(Error::kBelowMinimum, Quantity::kDuration, move.duration_s, plan.duration_ticks * config_.tick_s);
    const Status status = stretch(plan, static_cast<uint32_t>(ticks));
    if (!status.ok()) return status;
  }
  report.zero_delay_met = running().stage_count() == 0;
  return kOk;
}

Status AxisCore::time_zero_delay(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report) {
  const uint32_t length = running().length_ticks();
  const uint32_t spare = active_shaper_ ^ 1;
  Status status = shapers_[spare].configure(running(), memory_[spare], capacity_, start);
  if (!status.ok()) return status;
  ShapedMoveCheck check(plan, move.limits, move.jerk_limited(), config_.tick_s, shapers_[spare],
                        tracks_[active_track_ ^ 1], start, target);
  Quantity binding = Quantity::kDuration;
  if (plan.distance == 0.0) {
    report.zero_delay_met = true;
    return kOk;
  }
  if (move.duration_s == 0.0) return stretch(plan, check.least_ticks(0, plan.duration_ticks, binding));
  const uint32_t wanted = static_cast<uint32_t>(math::floor(move.duration_s / config_.tick_s * (1.0 + 1e-12)));
  const uint32_t available = wanted > length ? wanted - length : 0;
  if (available < plan.duration_ticks) {
    uint32_t least = plan.duration_ticks;
    // For a shaper that may raise peaks the plan is below its limits already: nothing is sustained.
    if (available > 0) binding = running().averages() ? sustained_limit(plan, length) : Quantity::kNone;
    if (binding == Quantity::kNone) {
      binding = plan.duration_ticks > kLongestSearchTicks ? Quantity::kDuration : check.broken_at(available);
      if (binding != Quantity::kNone) least = check.least_ticks(available, plan.duration_ticks, binding);
    }
    if (binding != Quantity::kNone)
      return refuse(Error::kLimitExceeded, binding, move.duration_s, (least + length) * config_.tick_s);
  }
  report.zero_delay_met = true;
  return stretch(plan, available);
}

}  // namespace stillpoint
