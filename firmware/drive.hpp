// SPDX-License-Identifier: Apache-2.0
// CiA 402: the drive's state, and the set-point handshake of profile position mode, unbuffered.
#pragma once

#include <stdint.h>

#include "firmware/control_loop.hpp"
#include "firmware/parameters.hpp"
#include "firmware/state_machine.hpp"
#include "shaper/axis/axis_core.hpp"

namespace stillpoint::firmware {

// Background only: the one owner of the CiA state. What must not wait for the background (the output stage, the fault
// latch, the ramps) is the control loop's, and this class follows it.
//
// Decisions where the standard leaves a choice:
//   - Halt (bit 8) ramps by the profile's limits, before the shaper, and so ends still; the move is given up and not
//     resumed, set-points are refused while the bit is set.
//   - Disable operation (5) ramps like that and then switches off; shutdown (8) and disable voltage (9) switch off at
//     once, whatever moves.
//   - Quick stop is option 2: ramp, then switch-on disabled.
//   - A set-point while the axis moves takes over in flight if it is to (bit 5, at once), with the profile's limits as
//     they are then; else it is refused (bit 12 stays 0, reason in 0012), never queued. In flight a relative one counts
//     from the target in force. One that comes while a shaper is on its way waits for it.
class Drive {
 public:
  void begin(AxisCore& axis, ControlLoop& loop, Parameters& parameters);

  // Register 0040. Takes effect in this call as far as it can without a tick.
  void write_controlword(uint16_t controlword);

  // As often as possible. Short.
  void service();

  // While the auto-tune has the axis, set-points are refused.
  void set_tuning(bool tuning) { tuning_ = tuning; }

  // 0, or the reason (0012) why the axis cannot be lent to anybody now.
  uint16_t reason_not_free() const;

  // Operation enabled, and nothing asks for anything else.
  bool may_move() const;

  // Plans and commands a set-point that waits. Long: see AxisCore::command. `shaper_waiting`: not yet.
  void take_set_point(bool shaper_waiting);

  DriveState state() const { return state_; }
  uint16_t statusword() const;

  // What `service` last saw; one tick's values.
  const LoopSnapshot& loop() const { return seen_; }

 private:
  void follow_loop();
  void obey();
  bool obey_enable(DriveState wanted);
  void obey_halt();
  void slow_down();
  void enter(DriveState state);
  bool target_reached() const;
  bool halt_asked() const { return (controlword_ & kControlHalt) != 0; }

  AxisCore* axis_ = nullptr;
  ControlLoop* loop_ = nullptr;
  Parameters* parameters_ = nullptr;

  LoopSnapshot seen_ = {};
  uint32_t tick_us_ = 0;
  uint16_t controlword_ = 0;
  DriveState state_ = DriveState::kNotReady;
  int32_t target_ = 0;     // of the last move taken
  bool standing_ = false;  // at rest, and nothing waits to change that
  bool enabling_ = false;  // in switched on: the output stage has been asked for
  bool slowing_ = false;   // in operation enabled: the ramp before disabling
  bool halting_ = false;
  bool set_point_waits_ = false;
  bool set_point_taken_ = false;  // bit 12
  bool moving_ = false;           // from taking a set-point until the axis stands
  bool tuning_ = false;
  bool given_up_ = false;  // the last move was stopped on its way
};

}  // namespace stillpoint::firmware
