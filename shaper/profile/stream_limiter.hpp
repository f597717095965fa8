// SPDX-License-Identifier: Apache-2.0
// Setpoints that come from outside, one a tick, kept within limits.
#pragma once

#include <stdint.h>

#include "shaper/base/signal.hpp"
#include "shaper/profile/stop_ramp.hpp"
#include "shaper/profile/stream_limits.hpp"

namespace stillpoint {

enum class StreamPolicy : uint8_t {
  kClamp,  // what breaks a limit is followed within the limits
  kFault,  // ... is the last that is followed: it stops within the limits, and stands until it is started anew
};

// Gives out what comes in, bit for bit and with no delay, for as long as that keeps the limits and can go on keeping
// them: a stream that is one jerk short of passing the velocity limit whatever comes next has broken it already. Where
// it does not, the output goes on within the limits, towards the input, and is the input again once it can be and stay
// so: if the input then goes on at its acceleration, one more tick brings the velocities together.
//
// While it catches up it closes the gap on an ApproachCurve, in the frame that moves with the input: the hardest
// acceleration is taken from which the curve can still be met without passing it (next_braking), and no harder than
// lets go of it before the velocity limit. That takes up to 1.5 times as long as a plan, and 8 ticks. It passes a
// standing input by no more than a stop at once does.
//
// Limits are those of StreamLimits, on the differences of what leaves; near a turn (a velocity below one tick of the
// larger acceleration) the larger of acceleration and deceleration holds. Positions wrap at the end of their range,
// and the way to the input is the shorter one. From outside its limits it comes back as the jerk allows.
//
// A stream rounded more coarsely than its jerk limit allows (4 times the rounding) is limited where it changes its
// velocity, and smoothed so.
//
// Tick context. Integers only, no division but by shifting. On a Cortex-M4 370 instructions on the average where the
// stream passes, 2200 while it catches up, 4300 at most in noise.
class StreamLimiter {
 public:
  // From the last three outputs, newest first, which are the input so far too. An input that does not come is made up
  // for `made_up_ticks` in a row. Clears a fault and the flag; the counter goes on.
  void start(const StreamLimits& limits, StreamPolicy policy, uint32_t made_up_ticks, Signal newest, Signal before,
             Signal before_that);

  // From here on it also stays between two positions, with the output inside: in front of one it stops in time. A
  // stream that brakes onto it later than leaves some room for the stop is limited. low >= high: no such ends. `start`
  // leaves them as they are.
  void keep_between(Signal low, Signal high);

  // Ramps to rest within the limits, whatever comes in, and stands until it is started anew.
  void stop();

  Signal tick(Signal input);
  // No input came in time: it is taken to go on at its acceleration, and after the ticks given to `start` to stand,
  // which a moving output then has to be limited for. In a stream of changing acceleration the guess is off by a jerk,
  // which takes up to four to make good.
  Signal tick();

  Signal position() const { return position_; }
  bool at_rest() const { return velocity_ == 0 && acceleration_ == 0; }
  bool limiting() const { return limiting_; }                // the last output was not its input
  uint32_t limited_ticks() const { return limited_ticks_; }  // only goes up, to its largest number
  bool faulted() const { return faulted_; }
  bool stopped() const { return stopping_ && at_rest(); }

 private:
  struct Step {
    int64_t velocity;
    int64_t acceleration;
  };

  static constexpr int kSmoothing = 3;

  Signal between(Signal input) const;
  bool stays_between(const Step& step) const;
  bool stops_within(const Step& motion, int64_t room) const;
  int64_t ended_at_once() const;
  int64_t stopping_at_once() const;
  void take_input(Signal input);
  int64_t smooth_acceleration() const { return accelerations_ >> kSmoothing; }
  bool reaches_input(Step& step) const;
  int64_t acceleration_limit(int64_t velocity_before, int64_t velocity) const;
  bool keeps_limits(const Step& step) const;
  bool can_go_on_within(const Step& step) const;
  bool can_stay_on_input(const Step& step) const;
  int64_t catching_up() const;
  int64_t below_velocity_limit(int64_t acceleration) const;
  int64_t towards_input(bool softly) const;
  Signal follow(Signal input);
  Signal advance(int64_t acceleration);

  StreamLimits limits_ = {};
  StreamPolicy policy_ = StreamPolicy::kClamp;
  bool faulted_ = false;
  bool stopping_ = false;
  bool limiting_ = false;
  uint32_t made_up_ticks_ = 0;
  uint32_t missed_ = 0;  // in a row
  uint32_t limited_ticks_ = 0;
  Signal low_ = 0;
  Signal high_ = 0;
  Signal input_ = 0;
  int64_t input_velocity_ = 0;  // within the velocity limit
  int64_t input_acceleration_ = 0;
  int64_t accelerations_ = 0;  // of the input, of the last 2^kSmoothing ticks: times that their mean
  Signal position_ = 0;
  int64_t velocity_ = 0;
  int64_t acceleration_ = 0;
  StopRamp ramp_ = {};
};

}  // namespace stillpoint
