// SPDX-License-Identifier: Apache-2.0
// How long a move takes: as planned, as wanted, or so that the shaped setpoint arrives in time.
#include <float.h>

#include "shaper/axis/axis_core.hpp"
#include "shaper/axis/raised_plan.hpp"
#include "shaper/axis/zero_delay.hpp"
#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

// Negative gains may raise peaks. Slowed down by the factor k, the first three differences stay within G v / k,
// G a / k^2 and G j / k^3 of either sign, G the peak gain: so k = max(G, sqrt(G r)), r the larger of the accelerations
// over the smaller, is certainly enough.
[[gnu::noinline]] double certainly_enough(double gain, const AxisLimits& limits) {
  const double ratio = limits.acceleration / limits.deceleration;
  const double by_acceleration = math::sqrt(gain * (ratio > 1.0 ? ratio : 1.0 / ratio));
  return by_acceleration > gain ? by_acceleration : gain;
}

Status refuse_duration(Quantity binding, double wanted_s, uint32_t least_ticks, double tick_s) {
  return refuse(Error::kLimitExceeded, binding, wanted_s, least_ticks * tick_s);
}

}  // namespace

ShapedMoveCheck AxisCore::check_for(const Move& move, Signal start, Signal target) {
  return ShapedMoveCheck(move.limits, move.jerk_limited(), config_.tick_s, shapers_[active_shaper_ ^ 1],
                         tracks_[active_track_ ^ 1], start, target);
}

Status AxisCore::time_move(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report) {
  if (plan.distance == 0.0 && move.zero_delay) {
    report.zero_delay_met = true;
    return kOk;
  }
  if (!running().averages() && plan.distance != 0.0) {
    const Status status = slow_down_for_shaper(move, start, target, plan, report);
    if (!status.ok()) return status;
  }
  return move.zero_delay ? time_zero_delay(move, start, target, plan, report)
                         : time_plainly(move, start, target, plan, report);
}

// Moves short enough to be looked at are slowed down no more than they need.
Status AxisCore::slow_down_for_shaper(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report) {
  const double enough = math::ceil(plan.duration_ticks * certainly_enough(shaper().peak_gain(), move.limits));
  if (enough > kMaxDurationTicks)
    return refuse(Error::kAboveMaximum, Quantity::kDuration, enough * config_.tick_s,
                  kMaxDurationTicks * config_.tick_s);
  Status status = fill_spare(start);
  if (!status.ok()) return status;
  uint32_t ticks = static_cast<uint32_t>(enough);
  if (plan.duration_ticks <= kLongestSearchTicks) {
    ShapedMoveCheck check = check_for(move, start, target);
    ticks = check.least_slowed_ticks(plan, plan.duration_ticks, ticks);
  }
  status = stretch(plan, ticks);
  report.timing = MoveTiming::kSlowed;
  return status;
}

Status AxisCore::time_plainly(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report) {
  const uint32_t least = plan.duration_ticks;
  if (move.duration_s != 0.0) {
    const double ticks = math::floor(move.duration_s / config_.tick_s + 0.5);
    if (ticks < least)
      return refuse(Error::kBelowMinimum, Quantity::kDuration, move.duration_s, least * config_.tick_s);
    const Status status = stretch(plan, static_cast<uint32_t>(ticks));
    if (!status.ok()) return status;
  }
  report.zero_delay_met = running().stage_count() == 0;
  report.peaks = peaks_of(plan, config_.tick_s);
  if (report.timing == MoveTiming::kPlain) return kOk;
  // Negative gains: what keeps the limits in one duration need not in a longer one.
  ShapedMoveCheck check = check_for(move, start, target);
  const Quantity binding = check.broken(plan);
  report.peaks = check.peaks();
  if (binding == Quantity::kNone) return kOk;
  const double factor = certainly_enough(shaper().peak_gain(), move.limits);
  const double certain = math::ceil(factor * static_cast<double>(plan.duration_ticks));
  if (certain > kMaxDurationTicks) return refuse_duration(binding, move.duration_s, least, config_.tick_s);
  const uint32_t longer = check.least_slowed_ticks(plan, plan.duration_ticks, static_cast<uint32_t>(certain));
  return refuse_duration(binding, move.duration_s, longer, config_.tick_s);
}

Status AxisCore::time_zero_delay(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report) {
  const bool asked = move.duration_s != 0.0;
  const uint32_t length = running().length_ticks();
  const double wanted = math::floor(move.duration_s / config_.tick_s * (1.0 + 1e-12));
  const uint32_t available = wanted > length ? static_cast<uint32_t>(wanted) - length : 0;
  const bool too_long = plan.duration_ticks > kLongestSearchTicks;
  report.zero_delay_met = asked || running().stage_count() == 0;
  if (asked && too_long && available < plan.duration_ticks) {
    const Quantity sustained = running().averages() ? sustained_limit(plan, length) : Quantity::kNone;
    return refuse_duration(available == 0 || sustained == Quantity::kNone ? Quantity::kDuration : sustained,
                           move.duration_s, plan.duration_ticks + length, config_.tick_s);
  }
  if (running().averages() && (available >= plan.duration_ticks || too_long || running().stage_count() == 0)) {
    return time_within(move, start, target, asked ? available : plan.duration_ticks, plan, report);
  }
  const Status status = fill_spare(start);
  if (!status.ok()) return status;
  return time_sooner(move, start, target, asked ? available : UINT32_MAX, plan, report);
}

// A mean of the past of a profile that keeps its limits keeps them too: the stream is run for its peaks alone.
Status AxisCore::time_within(const Move& move, Signal start, Signal target, uint32_t ticks, Plan& plan,
                             MoveReport& report) {
  report.timing = MoveTiming::kWithin;
  Status status = stretch(plan, ticks);
  report.peaks = peaks_of(plan, config_.tick_s);
  if (!status.ok() || ticks > kLongestSearchTicks) return status;
  status = fill_spare(start);
  if (!status.ok()) return status;
  ShapedMoveCheck check = check_for(move, start, target);
  if (check.broken(plan) == Quantity::kNone) report.peaks = check.peaks();
  return status;
}

// The raised plan and the plain one, each slowed down or sped up to what is available, if its stream keeps the limits
// there; of the two the one with the lower peaks. Else the raised plan as it is, which ends before that.
[[gnu::noinline]] Status AxisCore::time_sooner(const Move& move, Signal start, Signal target, uint32_t available,
                                               Plan& plan, MoveReport& report) {
  ShapedMoveCheck check = check_for(move, start, target);
  CheckedPlan best = SoonestSearch(check, shaper(), move, plan, config_.tick_s).find();
  if (best.plan.duration_ticks > available) {
    const Quantity binding = available == 0 ? Quantity::kDuration : best.binding;
    const uint32_t least = best.plan.duration_ticks + running().length_ticks();
    return refuse_duration(binding, move.duration_s, least, config_.tick_s);
  }
  if (available != UINT32_MAX) {
    const MoveTiming timing[] = {best.timing, MoveTiming::kSpedUp};
    const Plan raised = best.plan;
    const Plan* const plans[] = {&raised, &plan};
    best.use = DBL_MAX;
    for (int i = 0; i < 2; ++i) {
      Plan stretched = *plans[i];
      if (!stretch(stretched, available).ok() || check.broken(stretched) != Quantity::kNone) continue;
      if (check.use() < best.use) best = CheckedPlan{stretched, timing[i], best.binding, check.peaks(), check.use()};
    }
  }
  plan = best.plan;
  report.timing = best.timing;
  report.binding = best.binding;
  report.peaks = best.peaks;
  return kOk;
}

}  // namespace stillpoint
