// SPDX-License-Identifier: Apache-2.0
// CiA 402: the drive's state, and its modes: profile position with the set-point handshake and one set-point kept,
// profile velocity, homing where it stands, a stream of positions.
#pragma once

#include <stdint.h>

#include "firmware/control_loop.hpp"
#include "firmware/parameters.hpp"
#include "firmware/position_stream.hpp"
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
//     once, whatever moves. What is asked for while it ramps is lost; enable operation then calls off the switching
//     off, not the ramp.
//   - Quick stop is what 0078 says; by delivery option 2, a ramp at the quick-stop limits, then switch-on disabled.
//     From one that stays (5, 6) enable operation goes on once it stands; target reached (bit 10) says that it does.
//   - A fault reaction is what 0079 says. The profile's ramp (1) is begun here and so waits for a plan under way; where
//     that takes more than kRampPatienceTicks the loop stops by itself.
//   - A set-point while the axis moves takes over in flight if it is to (bit 5, at once), with the profile's limits as
//     they are then; else it is kept, with its limits, until the axis stands, and bit 12 stays up until then. Behind
//     one that is kept others are refused, but for one at once, which replaces both. A relative one counts from the
//     target in force. One that comes while a shaper is on its way waits for it. A halt, a stop and whatever ends
//     operation enabled drop the kept one; so do another mode and, in its turn, a refusal, which are in 0012. Bit 12
//     is then down, and bit 10 says what it said before.
//   - Another mode (0042) is in force, and shown (0043), once the axis stands.
//   - Profile velocity: what is written to 0052 while enabled is followed at once, with the profile's limits. Enabling,
//     entering the mode and every stop but a halt set 0052 to 0, so that none ever starts a motion. A halt slows to 0
//     and goes on after. Target reached (bit 10): the setpoint has the velocity of 0052, not one before it that goes on
//     because that was refused. Internal limit (bit 11): a soft limit holds it.
//   - Homing (bit 4 rising, at rest): the place where the axis stands becomes position 0 (methods 35 and 37), in one
//     tick, without motion. Bit 12 stays until the next homing or mode.
//   - Stream: bit 4 rising, at rest, begins with what has been written to 0090, whose first position is where the axis
//     stands; its falling ends it by the profile's ramp and drops what waits. So do enabling and any change of mode,
//     also where no stream runs: positions count from when the mode is shown. Bit 12: it is followed exactly.
class Drive {
 public:
  void begin(AxisCore& axis, ControlLoop& loop, Parameters& parameters, PositionStream& stream);

  // Register 0040. Takes effect in this call as far as it can without a tick.
  void write_controlword(uint16_t controlword);

  // Register 0052 has been written.
  void write_velocity();

  // As often as possible. Short.
  void service();

  // While the auto-tune has the axis, set-points are refused.
  void set_tuning(bool tuning) { tuning_ = tuning; }

  // 0, or the reason (0012) why the axis cannot be lent to anybody now.
  uint16_t reason_not_free() const;

  // Something waits for take_set_point.
  bool is_asked() const { return set_point_waits_ || (buffered_ && standing_) || velocity_is_asked(); }

  // Operation enabled, and nothing asks for anything else.
  bool may_move() const;

  // Plans and commands what waits: a set-point, another velocity. Long: see AxisCore::command. `shaper_waiting`: not
  // yet.
  void take_set_point(bool shaper_waiting);

  DriveState state() const { return state_; }
  uint16_t statusword() const;

  // What `service` last saw; one tick's values.
  const LoopSnapshot& loop() const { return seen_; }

 private:
  void follow_mode();
  void take_target();
  bool start(const Move& move);
  void forget_commands();
  void take_velocity();
  void see_velocity(uint32_t tick, Signal setpoint);
  void follow_command();
  void home();
  void begin_stream();
  void follow_stream();
  void start_mode();
  void follow_loop();
  void obey();
  bool obey_enable(DriveState wanted);
  void obey_halt();
  void quick_stop();
  bool goes_on() const;
  void ramp_for_fault();
  StopOption option(Register name) const;
  void slow_down();
  void enter(DriveState state);
  bool target_reached() const;
  bool velocity_is_asked() const { return velocity_waits_ && mode_ == OperationMode::kProfileVelocity; }
  uint32_t mode_bits() const;
  bool halt_asked() const { return (controlword_ & kControlHalt) != 0; }

  AxisCore* axis_ = nullptr;
  ControlLoop* loop_ = nullptr;
  Parameters* parameters_ = nullptr;
  PositionStream* stream_ = nullptr;

  LoopSnapshot seen_ = {};
  uint32_t tick_us_ = 0;
  uint16_t controlword_ = 0;
  OperationMode mode_ = {};  // in force
  DriveState state_ = DriveState::kNotReady;
  int32_t target_ = 0;         // of the last move taken
  bool standing_ = false;      // at rest, and nothing waits to change that
  bool enabling_ = false;      // in switched on: the output stage has been asked for
  bool stays_ = false;         // in quick stop active: until told to go on
  uint32_t ramped_fault_ = 0;  // the loop's fault_count that has been looked at
  bool slowing_ = false;       // in operation enabled: the ramp before disabling
  bool halting_ = false;
  bool set_point_waits_ = false;
  bool set_point_taken_ = false;  // bit 12
  bool buffered_ = false;         // `next_` is to follow the move in force; bit 12 too
  Move next_ = {};
  bool moving_ = false;  // from taking a set-point until the axis stands
  bool tuning_ = false;
  bool given_up_ = false;        // the last move was stopped on its way
  int32_t velocity_ = 0;         // asked of the axis, in profile velocity
  bool velocity_waits_ = false;  // written, and neither taken nor refused yet
  Signal velocity_change_ = 0;   // a tick, at that velocity
  bool at_velocity_ = false;     // the setpoint, between the newest two ticks that `service` saw
  uint32_t homings_ = 0;         // the loop's
  bool homing_ = false;
  bool homed_ = false;
  bool homing_failed_ = false;
};

}  // namespace stillpoint::firmware
