// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/stream_limiter.hpp"

#include "shaper/base/divide.hpp"
#include "shaper/base/wide.hpp"
#include "shaper/profile/braking.hpp"

namespace stillpoint {

namespace {

constexpr int64_t magnitude(int64_t value) { return value < 0 ? -value : value; }

constexpr int64_t clamped(int64_t value, int64_t most) { return value > most ? most : value < -most ? -most : value; }

constexpr int64_t at_least_one(int64_t value) { return value > 1 ? value : 1; }

// Letting go of `braking` by the jerk a tick, from the next on: does it come below `acceleration` before the velocity,
// `velocity` now, is below -turn? The last tick that is above begins with the velocity of k - 1 ticks.
bool softens_before(int64_t velocity, int64_t braking, int64_t acceleration, int64_t turn, int64_t jerk) {
  if (braking <= acceleration) return true;
  const uint64_t k = divide(static_cast<uint64_t>(braking - acceleration - 1), static_cast<uint64_t>(jerk));
  if (k <= 1) return k == 0 || velocity + turn > 0;
  const int64_t room = velocity + turn;
  if (room <= 0) return false;
  const Wide twice = multiply(k - 1, 2 * static_cast<uint64_t>(braking) - k * static_cast<uint64_t>(jerk));
  return twice.high == 0 && twice.low < 2 * static_cast<uint64_t>(room);
}

}  // namespace

void StreamLimiter::start(const StreamLimits& limits, StreamPolicy policy, uint32_t made_up_ticks, Signal newest,
                          Signal before, Signal before_that) {
  limits_ = limits;
  policy_ = policy;
  made_up_ticks_ = made_up_ticks;
  missed_ = 0;
  faulted_ = false;
  stopping_ = false;
  limiting_ = false;
  position_ = newest;
  velocity_ = within_motion_limit(wrapping_difference(newest, before));
  acceleration_ = within_motion_limit(velocity_ - within_motion_limit(wrapping_difference(before, before_that)));
  input_ = newest;
  input_velocity_ = clamped(velocity_, limits.velocity);
  input_acceleration_ = clamped(acceleration_, limits.larger_acceleration());
  accelerations_ = input_acceleration_ * (1 << kSmoothing);
}

void StreamLimiter::keep_between(Signal low, Signal high) {
  low_ = low;
  high_ = high;
}

Signal StreamLimiter::tick(Signal input) {
  missed_ = 0;
  const Signal output = follow(between(input));
  limiting_ = output != input;
  if (limiting_ && limited_ticks_ != UINT32_MAX) ++limited_ticks_;
  return output;
}

Signal StreamLimiter::follow(Signal input) {
  take_input(input);
  Step step{};
  if (stopping_) return advance(0);
  if (reaches_input(step) && stays_between(step)) return advance(step.acceleration);
  if (policy_ == StreamPolicy::kFault) {
    faulted_ = true;
    stop();
    return advance(0);
  }
  const int64_t acceleration = catching_up();
  return advance(stays_between(Step{velocity_ + acceleration, acceleration}) ? acceleration : stopping_at_once());
}

Signal StreamLimiter::tick() {
  const bool made_up = missed_ < made_up_ticks_;
  const uint32_t missed = made_up ? missed_ + 1 : missed_;
  const Signal output = tick(made_up ? wrapping_sum(input_, input_velocity_ + input_acceleration_) : input_);
  missed_ = missed;
  return output;
}

// A step above the velocity limit is a jump of the position and says nothing about the velocity.
void StreamLimiter::take_input(Signal input) {
  const int64_t step = within_motion_limit(wrapping_difference(input, input_));
  input_acceleration_ = 0;
  if (magnitude(step) <= limits_.velocity) {
    input_acceleration_ = step - input_velocity_;
    input_velocity_ = step;
  }
  const bool credible = magnitude(input_acceleration_) <= limits_.larger_acceleration();
  const int64_t change = (credible ? input_acceleration_ : 0) - smooth_acceleration();
  accelerations_ += clamped(change, 4 * limits_.jerk);
  input_ = input;
}

bool StreamLimiter::reaches_input(Step& step) const {
  step.velocity = within_motion_limit(wrapping_difference(input_, position_));
  step.acceleration = within_motion_limit(step.velocity - velocity_);
  return keeps_limits(step) && (!limiting_ || can_stay_on_input(step));
}

// Near a turn, where the sign of the velocity within the tick says little, the larger limit holds.
int64_t StreamLimiter::acceleration_limit(int64_t velocity_before, int64_t velocity) const {
  const int64_t larger = limits_.larger_acceleration();
  if ((velocity > 0) != (velocity_before > 0) || magnitude(velocity) < larger || magnitude(velocity_before) < larger)
    return larger;
  return magnitude(velocity) > magnitude(velocity_before) ? limits_.acceleration : limits_.deceleration;
}

bool StreamLimiter::keeps_limits(const Step& step) const {
  return magnitude(step.velocity) <= limits_.velocity && magnitude(step.acceleration - acceleration_) <= limits_.jerk &&
         magnitude(step.acceleration) <= acceleration_limit(velocity_, step.velocity) && can_go_on_within(step);
}

// Letting go of the acceleration at the jerk limit, if nothing better comes: that leads no farther than any other.
bool StreamLimiter::can_go_on_within(const Step& step) const {
  const bool upwards = step.acceleration > 0;
  const int64_t acceleration = magnitude(step.acceleration);
  const int64_t room = limits_.velocity - (upwards ? velocity_ : -velocity_);
  if (room < 0 || !can_let_go(acceleration, limits_.jerk, room)) return false;
  return softens_before(upwards ? -step.velocity : step.velocity, acceleration, limits_.acceleration,
                        limits_.larger_acceleration(), limits_.jerk);
}

// If the input goes on at its acceleration: its velocity in one more tick, and its acceleration in two.
bool StreamLimiter::can_stay_on_input(const Step& step) const {
  const int64_t relative = step.velocity - input_velocity_;
  const int64_t next = input_acceleration_ - relative;
  return magnitude(relative) <= limits_.jerk && magnitude(next - step.acceleration) <= limits_.jerk &&
         magnitude(next) <= acceleration_limit(step.velocity, step.velocity + next);
}

int64_t StreamLimiter::catching_up() const {
  const int64_t beyond = magnitude(velocity_) - limits_.velocity;
  if (beyond > 0) {
    const int64_t braking = velocity_ > 0 ? -acceleration_ : acceleration_;
    const int64_t next = next_braking(beyond, braking, limits_.deceleration, limits_.jerk, limits_.jerk);
    return velocity_ > 0 ? -next : next;
  }
  const int64_t hard = below_velocity_limit(towards_input(false));
  if (keeps_limits(Step{velocity_ + hard, hard})) return hard;
  return below_velocity_limit(towards_input(true));
}

int64_t StreamLimiter::below_velocity_limit(int64_t acceleration) const {
  const int64_t sign = acceleration > 0 ? 1 : -1;
  const int64_t room = limits_.velocity - sign * velocity_;
  if (can_let_go(sign * acceleration, limits_.jerk, room)) return acceleration;
  return sign * next_braking(room, sign * acceleration_, limits_.smaller_acceleration(), limits_.jerk, limits_.jerk);
}

// In the direction of the gap. The distance of the velocity below the curve is what closing faster than the curve falls
// uses up, and that is let go in time; above it, the other way round, with the jerk that the curve leaves. Braking is
// deceleration as long as the input does not come the other way; speeding up is, where it moves away from the input.
int64_t StreamLimiter::towards_input(bool softly) const {
  const int64_t gap = within_motion_limit(wrapping_difference(wrapping_difference(input_, input_velocity_), position_));
  const int64_t sign = gap < 0 ? -1 : 1;
  const int64_t ahead = softly ? 0 : sign * smooth_acceleration();
  const int64_t closing = sign * (velocity_ - input_velocity_) + ahead;
  const int64_t braking = ahead - sign * acceleration_;
  const bool brakes_softly = softly || sign * input_velocity_ < 0;
  const int64_t smaller = limits_.smaller_acceleration();
  const int64_t hardest = (brakes_softly ? smaller : limits_.deceleration) + ahead;
  const int64_t speeding = (softly                 ? smaller
                            : sign * velocity_ < 0 ? limits_.deceleration
                                                   : limits_.acceleration) -
                           ahead;
  const ApproachCurve& curve = brakes_softly ? limits_.soft_curve : limits_.curve;
  const ApproachCurve::Point on_curve = curve.at(magnitude(gap));
  const int64_t below = on_curve.velocity + on_curve.braking - closing;
  const int64_t falling = on_curve.braking - braking;  // of `below`, a tick
  const int64_t jerk = limits_.jerk;
  const int64_t next =
      below >= 0 ? next_braking(below, falling, at_least_one(on_curve.braking + speeding), jerk, jerk)
                 : -next_braking(-below, -falling, at_least_one(hardest - on_curve.braking), jerk, jerk - curve.jerk());
  int64_t harder = on_curve.braking - next;
  if (closing < 0) {  // to turn is at least as urgent as a stop
    const int64_t stopping = -next_braking(-closing, -braking, at_least_one(speeding), jerk, jerk);
    if (stopping < harder) harder = stopping;
  }
  return sign * (ahead - harder);
}

void StreamLimiter::stop() {
  const Signal before = wrapping_difference(position_, velocity_);
  ramp_.start(StopLimits{limits_.deceleration, limits_.jerk}, position_, before,
              wrapping_difference(before, velocity_ - acceleration_));
  stopping_ = true;
}

Signal StreamLimiter::advance(int64_t acceleration) {
  if (stopping_) {
    const Signal next = ramp_.tick();
    acceleration = wrapping_difference(next, position_) - velocity_;
  }
  acceleration_ = acceleration;
  velocity_ = within_motion_limit(velocity_ + acceleration);
  position_ = wrapping_sum(position_, velocity_);
  return position_;
}

Signal StreamLimiter::between(Signal input) const {
  if (low_ >= high_) return input;
  return input > high_ ? high_ : input < low_ ? low_ : input;
}

// Who stops at once from where there is room for it stays inside, so nothing else needs to be looked ahead to.
bool StreamLimiter::stays_between(const Step& step) const {
  if (low_ >= high_) return true;
  const Signal position = wrapping_sum(position_, step.velocity);
  return stops_within(step, wrapping_difference(high_, position)) &&
         stops_within(Step{-step.velocity, -step.acceleration}, wrapping_difference(position, low_));
}

// What velocity from rest the next tick can end.
int64_t StreamLimiter::ended_at_once() const {
  const int64_t half = limits_.jerk / 2;
  return half < limits_.smaller_acceleration() ? half : limits_.smaller_acceleration();
}

// At rest too near an end for anything more: what the next tick can end.
int64_t StreamLimiter::stopping_at_once() const {
  if (at_rest()) return clamped(within_motion_limit(wrapping_difference(input_, position_)), ended_at_once());
  const bool forward = velocity_ > 0 || (velocity_ == 0 && acceleration_ > 0);
  const int64_t braking = next_braking(forward ? velocity_ : -velocity_, forward ? -acceleration_ : acceleration_,
                                       limits_.deceleration, limits_.jerk, limits_.jerk);
  return forward ? -braking : braking;
}

// No more than this is travelled by a stop at once: the velocity gained until the acceleration is let go, for as long
// as that takes and as the braking takes to build up and to let go, and v^2 / 2D; two ticks more for what the whole
// ticks round up.
bool StreamLimiter::stops_within(const Step& motion, int64_t room) const {
  const int64_t half = ended_at_once();
  if (room < 0) return motion.velocity <= 0 && motion.acceleration <= 0;
  if (motion.velocity <= half && motion.acceleration <= half && motion.acceleration >= -half) return true;
  const auto speeding = static_cast<uint64_t>(motion.acceleration > 0 ? motion.acceleration : 0);
  const auto jerk = static_cast<uint64_t>(limits_.jerk);
  const uint64_t letting_go = divide(speeding, jerk) + 1;
  const Wide gained = multiply(speeding, letting_go);
  const int64_t fastest = motion.velocity + static_cast<int64_t>(gained.low / 2);
  if (gained.high != 0 || fastest > kMotionLimit) return false;
  if (fastest <= 0) return true;
  const auto speed = static_cast<uint64_t>(fastest);
  const auto braking = static_cast<uint64_t>(limits_.deceleration);
  const uint64_t in_jerks = divide(speed, jerk);
  uint64_t building = divide(braking, jerk) + 1;
  if (multiply(building, building).high != 0 || building * building > in_jerks) building = root(in_jerks) + 1;
  const Wide meanwhile = multiply(speed, letting_go + building + 2);
  if (meanwhile.high != 0 || meanwhile.low > static_cast<uint64_t>(room)) return false;
  const Wide left = multiply(2 * (static_cast<uint64_t>(room) - meanwhile.low), braking);
  const Wide square = multiply(speed, speed);
  return square.high < left.high || (square.high == left.high && square.low <= left.low);
}

}  // namespace stillpoint
