// SPDX-License-Identifier: Apache-2.0
// The once-a-tick chain: setpoint out, feedback in, and the watch over both.
#pragma once

#include <stdint.h>

#include "firmware/feedback_watch.hpp"
#include "firmware/registers.hpp"
#include "hal/servo_port.hpp"
#include "shaper/axis/axis_core.hpp"
#include "shaper/base/shared.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint::firmware {

constexpr uint32_t kMissingInARowFault = 3;
constexpr uint32_t kSilentMsFault = 100;
// A link that stays dead carries no ramp either: the drive is then declared disabled.
constexpr uint32_t kSilentMsAbandon = 1000;
// How long a fault waits for the background to begin the ramp that it is to end with.
constexpr uint32_t kRampPatienceTicks = 20;

// One tick's values. Counters only go up, and wrap.
struct LoopSnapshot {
  AxisState axis;
  Signal position;         // newest valid feedback
  Signal position_change;  // since the feedback of the tick before; kept over missing ones
  FaultCode fault;         // latched until cleared
  uint32_t fault_count;    // of all faults
  bool enabled;            // what the drive was told
  bool feedback_valid;     // the newest feedback was fresh and valid
  bool link_silent;        // no tick for kSilentMsFault of the own timer
  uint32_t settled_ticks;  // ticks in a row that the axis stood with its position in the window; stops at the maximum
  uint32_t ticks;
  uint32_t missing;
  uint32_t link_losses;
  uint32_t overruns;
  uint32_t homings;
};

// What clients are shown of it; both saturate. Tick or background.
int32_t counts_per_second(Signal change_per_tick, uint32_t ticks_per_second);
int32_t following_error(const LoopSnapshot& loop);  // setpoint less position, in whole counts; 0 while disabled

// Who may call what: `tick` and `own_timer_tick` are the tick's context (interrupts of one priority, or both called
// from the background); everything else is the background's. The background asks through words of 32 bits that it alone
// writes, but for two that the tick clears; it answers in the snapshot. A zero-initialised loop is valid storage.
//
// Enabling, the fault latch and the ramp are decided in the tick, so that a background that plans for a second
// delays none of them.
class ControlLoop {
 public:
  // Background, before the first tick.
  void begin(AxisCore& axis, hal::ServoPort& servo);

  // --- background -------------------------------------------------------------------------------------------------

  // Asks for the output stage. On: at the next tick with valid feedback and without a fault, from the actual position.
  // Off: at the next tick, whatever moves; a fault's ramp is not cut short by it.
  void request_enabled(bool enabled) { store(wanted_enabled_, enabled ? 1 : 0); }

  // Clears the fault once the reaction to it is over. A fault that still exists comes back when enabled again.
  void request_fault_clear() { store(clear_requested_, load(clear_requested_) + 1); }

  // Half the width of the band around the setpoint in which the axis counts as settled.
  void set_position_window(uint32_t counts) { store(window_counts_, counts); }

  // What the tick watches, from here on.
  void watch(const FeedbackLimits& limits) { feedback_watch_.set(limits); }
  uint32_t beyond_limit(Signal position) const { return feedback_watch_.beyond_limit(position); }

  // Homing where it stands: at the next tick that finds the axis enabled and at rest, that place becomes `counts`, and
  // `homings` in the snapshot goes up. Nothing moves. What the drive is told and reads is counted from there since.
  // It waits for that until it is taken back.
  void request_home(int32_t counts) {
    home_counts_ = counts;
    store(home_requested_, 1);
  }
  void take_home_back() { store(home_requested_, 0); }

  // How a fault ends: kOff, kRamp or kQuick. For kRamp the background is to halt the axis once it sees the fault, and
  // say so by `note_ramp`, with the count of the fault; where that takes too long the quick stop comes instead. kQuick
  // after `begin`.
  void set_fault_option(StopOption option) { store(fault_option_, static_cast<uint32_t>(option)); }
  void note_ramp(uint32_t fault_count) { store(ramped_fault_, fault_count); }

  // A client that has been heard; while enabled the next must come within `set_client_watchdog`'s time (0: for ever).
  void note_client() { store(client_heard_, load(client_heard_) + 1); }
  void set_client_watchdog(uint32_t ms) { store(client_watchdog_ms_, ms); }

  // A fault that was seen elsewhere: latched at the next tick or millisecond, unless there is one already.
  void request_fault(FaultCode fault) { store(requested_fault_, static_cast<uint32_t>(fault)); }

  // Never torn: read again if a tick came between.
  LoopSnapshot snapshot() const { return published_.read(); }
  void snapshot(LoopSnapshot& copy) const { published_.read(copy); }
  // Of the newest one.
  FaultCode fault() const {
    const volatile FaultCode& fault = now().fault;
    return fault;
  }

  // --- tick -------------------------------------------------------------------------------------------------------

  // Hands over this tick's setpoint and takes the newest feedback. Bounded; no division, no floating point, no error.
  void tick();

  // What the newest tick published.
  const LoopSnapshot& now() const { return published_.latest(); }

  // After a tick that had not ended when the next was due. Two in a row are a fault.
  void note_overrun();
  // What this tick saw, after it.
  TuneSample sample() const { return {state_.axis.setpoint, state_.position, acceleration_, state_.feedback_valid}; }

  // Once a millisecond of the chip's own timer.
  void own_timer_tick();

 private:
  void obey_clear_and_disable();
  void enable_if_asked();
  void take(const hal::ServoFeedback& feedback);
  uint32_t lost_before(uint16_t sequence);
  void home_if_asked();
  void watch_feedback(Signal setpoint);
  void watch_client();
  void take_requested_fault();
  void wait_for_ramp();
  void raise(FaultCode fault);
  void end_fault_reaction();
  void switch_off(Signal position);
  void count_settled(const AxisState& axis);
  void publish();

  AxisCore* axis_ = nullptr;
  hal::ServoPort* servo_ = nullptr;

  // Written by the background, and by it alone but where the tick is named.
  uint32_t wanted_enabled_ = 0;
  uint32_t clear_requested_ = 0;
  uint32_t window_counts_ = 0;
  uint32_t home_requested_ = 0;  // the tick clears it too
  int32_t home_counts_ = 0;
  uint32_t fault_option_ = 0;  // StopOption
  uint32_t ramped_fault_ = 0;  // the fault_count that it has begun the ramp of
  uint32_t client_heard_ = 0;
  uint32_t client_watchdog_ms_ = 0;
  uint32_t requested_fault_ = 0;  // FaultCode; the tick clears it, and alone

  // The tick's own.
  LoopSnapshot state_ = {};
  Signal home_ = 0;  // on the servo link, of what is position 0 here
  FeedbackWatch feedback_watch_ = {};
  uint32_t cleared_ = 0;
  bool awaits_ramp_ = false;  // a fault that is to end with a ramp has not seen it begin
  bool ramping_ = false;
  uint32_t ramp_ticks_ = 0;  // waited for it
  uint32_t client_seen_ = 0;
  uint32_t client_silent_ms_ = 0;
  uint32_t missing_in_a_row_ = 0;
  uint32_t silent_ms_ = 0;
  int32_t acceleration_ = 0;  // newest valid feedback
  uint16_t last_sequence_ = 0;
  bool overrun_now_ = false;   // the newest tick
  bool overran_ = false;       // the one before
  bool neighbours_ = false;    // the newest two feedbacks are of neighbouring ticks
  bool following_ = false;     // last_sequence_ is of the feedback just before
  bool commit_ = false;        // of the exchange before
  bool told_enabled_ = false;  // what the drive last heard: it must hear of an off before it is on again

  Snapshot<LoopSnapshot> published_;
};

}  // namespace stillpoint::firmware
