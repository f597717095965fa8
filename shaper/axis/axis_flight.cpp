// SPDX-License-Identifier: Apache-2.0
// The background's side of motion that is changed in flight: another target, a velocity, a halt.
#include "shaper/axis/axis_core.hpp"
#include "shaper/axis/flight_check.hpp"
#include "shaper/base/math.hpp"
#include "shaper/profile/extent.hpp"
#include "shaper/profile/plan_from.hpp"

namespace stillpoint {

namespace {

// Ticks that a plan may take to be made. One that is late is made again with twice as many.
constexpr uint32_t kShortestLeadTicks = 4;

[[gnu::noinline]] Status busy() { return refuse(Error::kBusy); }

double counts_of(const Wide& position) { return to_double(position, kTrackFractionBits); }

// plan_from uses as much of it as shortens a move.
[[gnu::noinline]] AxisLimits planned_limits(const Move& move) {
  AxisLimits limits = move.limits;
  if (!move.jerk_limited()) {
    limits.jerk = kNoJerkLimit;
    limits.deceleration_jerk = 0.0;
  }
  return limits;
}

// As wide both ways as the wider of two moves: what a hand-over between them may do, whichever way it goes.
AxisLimits around(const AxisLimits& a, const AxisLimits& b) {
  const double acceleration =
      math::greater(math::greater(a.acceleration, a.deceleration), math::greater(b.acceleration, b.deceleration));
  return AxisLimits{math::greater(a.velocity, b.velocity), acceleration, acceleration,
                    math::greater(a.larger_jerk(), b.larger_jerk())};
}

// An acceleration that the new jerk limit lets go of too late for the new velocity limit, or, where the motion turns
// round meanwhile, for the new acceleration limit: the jerk of the motion before lets go of it in time, or the axis
// would run past the old limits too. Afterwards the new ones hold.
struct Release {
  double ticks;  // 0: there is no need
  double jerk;   // counts/s^3, signed
  StartMotion after;
  double distance;
};

// Whether it does; `jerk` is the one that counts first.
bool too_late(const StartMotion& start, const AxisLimits& limits, double& jerk) {
  const double square = math::square(start.acceleration);
  const double speed = math::magnitude(start.velocity);
  jerk = limits.jerk;
  if (start.velocity * start.acceleration >= 0.0) return speed + square / (2.0 * jerk) > limits.velocity;
  jerk = limits.braking_jerk();
  const double turning = square - 2.0 * jerk * speed;
  return turning > math::square(limits.acceleration) || turning > 2.0 * limits.jerk * limits.velocity;
}

Release release_of(const StartMotion& start, const AxisLimits& limits, double jerk, double tick_s) {
  constexpr double kShortestTicks = 1.0 / 1024.0;
  const double a = start.acceleration;
  double by_limits = 0.0;
  if (!too_late(start, limits, by_limits) || jerk <= by_limits) return Release{0.0, 0.0, start, 0.0};
  const double shortest = kShortestTicks * tick_s;
  const double time = math::magnitude(a) > jerk * shortest ? math::magnitude(a) / jerk : shortest;
  const double signed_jerk = -a / time;
  return Release{time / tick_s, signed_jerk, StartMotion{start.velocity + a * time / 2.0, 0.0},
                 time * (start.velocity + time * (a / 2.0 + time * signed_jerk / 6.0))};
}

// The release before a plan from where it leads to. (Without room for another segment: later, from another state.)
Status prepend(const Release& release, const StartMotion& start, double tick_s, Plan& plan) {
  if (release.ticks == 0.0) return kOk;
  // The rest of the last tick is another's now.
  if (plan.segment_count != 0) {
    const Segment& last = plan.segments[plan.segment_count - 1];
    if (last.jerk == 0.0 && last.acceleration == 0.0) --plan.segment_count;
  }
  if (plan.segment_count + 1 >= kMaxSegments) return busy();
  for (uint32_t i = plan.segment_count; i > 0; --i) plan.segments[i] = plan.segments[i - 1];
  plan.segments[0] =
      Segment{release.ticks, start.acceleration * tick_s * tick_s, release.jerk * tick_s * tick_s * tick_s};
  plan.optimum_ticks += release.ticks;
  plan.duration_ticks = whole_ticks(plan.optimum_ticks);
  ++plan.segment_count;
  const double left = plan.duration_ticks - plan.optimum_ticks;
  if (left > 0.0) plan.segments[plan.segment_count++] = Segment{left, 0.0, 0.0};
  plan.start_velocity = start.velocity * tick_s;
  plan.distance += release.distance;
  return kOk;
}

}  // namespace

Status AxisCore::command_in_flight(const Move& move, MoveReport* report) {
  if (move.duration_s != 0.0 || move.zero_delay) return busy();
  flight_lead_ = kShortestLeadTicks;
  return fly(Flight{move, 0.0, false}, report);
}

Status AxisCore::jog(double velocity, const AxisLimits& limits, MoveReport* report) {
  if (!configured_) return refuse(Error::kNotAvailable);
  Status status = limits.validate();
  if (status.ok()) status = limits.within(config_.maximum);
  if (!status.ok()) return status;
  flight_lead_ = kShortestLeadTicks;
  return fly(Flight{Move{0, ProfileKind::kSCurve, limits, 0.0, false}, velocity, true}, report);
}

Status AxisCore::halt(const AxisLimits& limits, MoveReport* report) {
  if (!configured_) return refuse(Error::kNotAvailable);
  Status status = limits.validate();
  if (status.ok()) status = limits.within(config_.maximum);
  if (!status.ok()) return status;
  // From here on no tick takes what waits; one that did has done so before.
  store(pending_move_, kNoMove);
  __atomic_signal_fence(__ATOMIC_SEQ_CST);
  const AxisPhase phase = state().phase;
  if (report != nullptr) *report = MoveReport{};
  if (phase == AxisPhase::kStreaming) store(stream_end_requested_, 1);
  if (phase != AxisPhase::kMoving) return kOk;  // the profile stands, or is being stopped
  flight_lead_ = kShortestLeadTicks;
  Flight flight{Move{0, ProfileKind::kSCurve, limits, 0.0, false}, 0.0, true};
  status = fly(flight, report);
  if (status.quantity == Quantity::kPosition) {  // too weak to stay inside the soft limits
    flight.move.limits = config_.maximum;
    status = fly(flight, report);
  }
  if (!status.ok()) request_stop();
  return kOk;
}

// The track in force is only read by the tick, and no other can take its place while nothing is pending.
Status AxisCore::fly(const Flight& flight, MoveReport* report) {
  const uint32_t epoch = load(epoch_);
  const AxisState now = state();
  const uint32_t pending = load(pending_);
  const bool at_rest = now.phase == AxisPhase::kAtRest;
  if (now.phase == AxisPhase::kStopping || now.phase == AxisPhase::kStreaming) return busy();
  if (load(pending_move_) != kNoMove || pending == kBlend) return busy();
  if (at_rest && pending != kNothing) return busy();
  const uint32_t lead = at_rest ? 0 : flight_lead_;
  uint32_t unused = 0;
  Course course{};
  course.start =
      at_rest ? standing(now.setpoint) : tracks_[active_track_].differences_at(now.track_ticks + lead, unused);
  const Terms& in_force = terms_[active_track_];
  // The jerk of the motion in force: until its own release is over, of the one before.
  const bool releasing = now.track_ticks + lead < in_force.released_ticks;
  course.release_jerk = releasing ? in_force.release_jerk : planned_limits(in_force.move).larger_jerk();
  const bool only_checked = in_force.only_checked && !at_rest;
  Status status = running().averages() && !only_checked ? make_course(flight, now, course)
                                                        : make_checked_course(flight, now, lead, course);
  if (!status.ok()) return status;
  if (report != nullptr) {
    const uint32_t ticks = course.plan.duration_ticks;
    *report =
        MoveReport{ticks, ticks + running().length_ticks(), course.plan.optimum_ticks, running().stage_count() == 0};
  }
  terms_[active_track_ ^ 1] = Terms{flight.move, only_checked, true, course.release_jerk, course.released_ticks};
  flight_ = flight;
  flight_at_ = now.tick + lead;
  look_again_ = look_again_ || pending == kLaterShaper;
  look_again_at_ = flight_at_ + 1;
  hand_over_move(at_rest ? kFromRest : kInFlight, epoch);
  return kOk;
}

// Plans it, and fills the spare track.
Status AxisCore::make_course(const Flight& flight, const AxisState& now, Course& course) {
  Status status = flight.to_velocity ? plan_to_cruise(flight, course) : plan_to_target(flight.move, now.zero, course);
  if (status.ok()) status = check_extent(course);
  if (!status.ok()) return status;
  Track& next = tracks_[active_track_ ^ 1];
  if (course.to_target) {
    Track::make_from(course.plan, course.start, course.target, next);
  } else {
    Track::make_cruise(course.plan, course.start, course.cruise, next);
  }
  return status;
}

// Gains below zero may raise peaks: with less acceleration and jerk until the stream keeps the limits.
Status AxisCore::make_checked_course(const Flight& flight, const AxisState& now, uint32_t lead, Course& course) {
  static constexpr double kParts[] = {1.0, 0.7, 0.5, 0.35, 0.25};
  Status status = kOk;
  for (size_t i = 0; i < sizeof kParts / sizeof kParts[0]; ++i) {
    Flight slower = flight;
    slower.move.limits.acceleration *= kParts[i];
    slower.move.limits.deceleration *= kParts[i];
    slower.move.limits.jerk *= kParts[i];
    slower.move.limits.deceleration_jerk *= kParts[i];
    status = make_course(slower, now, course);
    if (status.ok()) status = check_stream(flight, now, lead);
    if (status.error != Error::kLimitExceeded) return status;
  }
  return status;
}

Status AxisCore::plan_to_target(const Move& move, Signal zero, Course& course) const {
  const StartMotion start = motion_of(course.start, config_.tick_s);
  const AxisLimits limits = planned_limits(move);
  const Release release = release_of(start, limits, course.release_jerk, config_.tick_s);
  Status status = find_target(move, course.start, zero, course.target);
  if (!status.ok()) return status;
  if (config_.modulo_counts != 0 && move.approach != Approach::kShortest) {
    // Ahead in the direction asked for, and no nearer than it can stop.
    Plan stop{};
    status = plan_to_velocity(release.after, 0.0, limits, config_.tick_s, stop);
    if (!status.ok()) return status;
    stop.distance += release.distance;
    const double sign = move.approach == Approach::kPositive ? 1.0 : -1.0;
    const Wide to_target = standing(course.target).difference[0] - course.start.difference[0];
    const double turns = math::ceil(sign * (stop.distance - counts_of(to_target)) / config_.modulo_counts);
    if (turns * config_.modulo_counts > kMaxPositionCounts)
      return refuse(Error::kAboveMaximum, Quantity::kDistance, stop.distance, kMaxPositionCounts);
    if (turns > 0.0) course.target = wrapping_sum(course.target, static_cast<Signal>(sign * turns) * turns_.counts);
  }
  course.to_target = true;
  const double distance = counts_of(standing(course.target).difference[0] - course.start.difference[0]);
  course.released_ticks = static_cast<uint32_t>(math::ceil(release.ticks));
  status = plan_from(release.after, distance - release.distance, limits, config_.tick_s, course.plan);
  return status.ok() ? prepend(release, start, config_.tick_s, course.plan) : status;
}

// Towards a soft limit it is a move to that limit, no faster than the jog.
Status AxisCore::plan_to_cruise(const Flight& flight, Course& course) const {
  const double velocity = flight.velocity;
  AxisLimits limits = planned_limits(flight.move);
  if (math::magnitude(velocity) > limits.velocity)
    return refuse(Error::kAboveMaximum, Quantity::kVelocity, velocity, limits.velocity);
  const StartMotion start = motion_of(course.start, config_.tick_s);
  const Release release = release_of(start, limits, course.release_jerk, config_.tick_s);
  course.released_ticks = static_cast<uint32_t>(math::ceil(release.ticks));
  Status status = kOk;
  if (config_.has_soft_limits() && velocity != 0.0) {
    const bool up = velocity > 0.0;
    const int32_t limit = up ? config_.soft_high_counts : config_.soft_low_counts;
    course.target = signal_from_counts(limit);
    course.to_target = true;
    const double from = counts_of(course.start.difference[0]);
    if (up ? from >= limit : from <= limit)
      return refuse(up ? Error::kAboveMaximum : Error::kBelowMinimum, Quantity::kPosition, from, limit);
    limits.velocity = math::magnitude(velocity);
    status = plan_from(release.after, limit - from - release.distance, limits, config_.tick_s, course.plan);
    return status.ok() ? prepend(release, start, config_.tick_s, course.plan) : status;
  }
  status = check_wrap(velocity);
  if (!status.ok()) return status;
  course.cruise = velocity * config_.tick_s;
  status = plan_to_velocity(release.after, velocity, limits, config_.tick_s, course.plan);
  return status.ok() ? prepend(release, start, config_.tick_s, course.plan) : status;
}

// A shaper tells two samples apart that are less than half the range apart.
[[gnu::noinline]] Status AxisCore::check_wrap(double velocity) const {
  const double most = kMaxPositionCounts / (config_.tick_s * (running().length_ticks() + 1.0));
  return math::magnitude(velocity) > most ? refuse(Error::kAboveMaximum, Quantity::kVelocity, velocity, most) : kOk;
}

Status AxisCore::check_extent(const Course& course) const {
  if (!config_.has_soft_limits()) return kOk;
  // A count's worth of what a plan of doubles may be off by.
  constexpr double kRounding = 1e-6;
  const double from = counts_of(course.start.difference[0]);
  const Extent extent = extent_of(course.plan);
  const double high = math::greater(from, config_.soft_high_counts) + kRounding;
  if (from + extent.highest > high)
    return refuse(Error::kAboveMaximum, Quantity::kPosition, from + extent.highest, config_.soft_high_counts);
  const double low = -math::greater(-from, -static_cast<double>(config_.soft_low_counts)) - kRounding;
  if (from + extent.lowest < low)
    return refuse(Error::kBelowMinimum, Quantity::kPosition, from + extent.lowest, config_.soft_low_counts);
  return kOk;
}

// The line holds what the track in force has fed it; what came before that track is not known.
[[gnu::noinline]] Status AxisCore::check_stream(const Flight& flight, const AxisState& now, uint32_t lead) {
  if (load(pending_) != kNothing || running().stage_count() == 0) return busy();
  const uint32_t spare = active_shaper_ ^ 1;
  const Track& next = tracks_[active_track_ ^ 1];
  const Status status = fill_spare(now.setpoint);
  if (!status.ok()) return status;
  // BlendLimits allows for the blend's rounding, which is not here.
  const uint32_t stages = running().stage_count() - 1;
  const AxisLimits& limits = flight.move.limits;
  const AxisLimits& before = now.phase == AxisPhase::kAtRest ? limits : terms_[active_track_].move.limits;
  const FlightLimits allowed{
      BlendLimits::make(around(limits, limits), flight.move.jerk_limited(), config_.tick_s, stages, true),
      BlendLimits::make(around(limits, before), flight.move.jerk_limited(), config_.tick_s, stages, true)};
  Quantity broken = Quantity::kDuration;
  if (now.phase == AxisPhase::kAtRest) {
    Track still{};
    still.start = standing(now.setpoint);
    still.end = still.start;
    broken = broken_in_flight(still, 0, next, allowed, shapers_[spare]);
  } else if (now.track_ticks < kLongestFlightCheckTicks) {
    const auto at = static_cast<uint32_t>(now.track_ticks) + lead;
    if (terms_[active_track_].may_turn && at < running().length_ticks() + 3) return busy();
    broken = broken_in_flight(tracks_[active_track_], at, next, allowed, shapers_[spare]);
  }
  return broken == Quantity::kNone ? kOk : refuse(Error::kLimitExceeded, broken, 0.0);
}

}  // namespace stillpoint
