// SPDX-License-Identifier: Apache-2.0
// What an Axis does, whatever its line capacity. See axis.hpp for who may call what.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/axis/axis_config.hpp"
#include "shaper/axis/blend.hpp"
#include "shaper/axis/blend_window.hpp"
#include "shaper/axis/turns.hpp"
#include "shaper/base/shared.hpp"
#include "shaper/profile/stop_ramp.hpp"
#include "shaper/profile/stream_limiter.hpp"
#include "shaper/profile/track.hpp"
#include "shaper/shaping/design.hpp"
#include "shaper/shaping/shaper.hpp"

namespace stillpoint {

class ShapedMoveCheck;

enum class Retune : uint8_t { kAtRest, kBlended };

class AxisCore {
 public:
  // --- background -------------------------------------------------------------------------------------------------

  // Takes limits and tick. Refuses an invalid configuration by name, and kBusy unless the axis is at rest with nothing
  // pending; the old one stays. A shaper is designed for a tick, so another tick is refused while one is in force.
  // Until the first success every command is refused kNotAvailable.
  Status configure(const AxisConfig& config);

  // At rest: plans the move from where the axis stands and hands it to the tick, which starts it at its next call that
  // allows a commit. Refuses kBusy while something is pending; whatever plan_rest_to_rest refuses; limits above the
  // axis's maximum; targets out of range or beyond a soft limit; for zero delay, and behind negative gains,
  // kLimitExceeded naming the limit that binds with the least duration in seconds that would do (behind negative gains
  // the next one that is known to). Zero delay (MoveTiming): a profile that keeps the limits by itself is taken as it
  // is. Else the soonest that the shaped stream allows, and the plain one, each stretched to the duration wanted: the
  // one with the lower peaks. Cost: one plan. Zero delay up to kLongestSearchTicks: one run through the stages; beyond
  // the profile's own limits 24 to 30 plans and 19 runs in the median of 1,000 random moves, 29 in a tenth, at most
  // SoonestSearch::kMostChecks + 2, each of the profile's ticks and the shaper's; a longer profile is not looked at.
  // Negative gains: at most 16 runs before that. Stack: 4 KB.
  //
  // In flight: another target, other limits or both, from where the profile will be a few ticks from now (the shaper
  // stays, and goes on with what it holds). The plan is plan_from's whatever the kind, but a trapezoid's jerk stays
  // without a limit; from outside new limits it comes back as plan_from says, without a dip below them and turning
  // round only where the target cannot be reached otherwise. The motion in force goes on until the tick that the new
  // one begins at, and if that has gone by when it is handed over, `service` plans again from further on. Refuses as at
  // rest; kBusy too for a duration or zero delay (they need rest), while stopping and in a blend of shapers; and
  // kLimitExceeded, where a shaper with negative gains or a motion sped up for zero delay would break a limit.
  //
  // `report` may be null.
  Status command(const Move& move, MoveReport* report);

  // What `command` at rest would do behind no shaper and without zero delay, and where the move would lead. Refuses as
  // that does, and hands over nothing. Cost: one plan.
  Status preview(const Move& move, Signal& target, MoveReport& report);

  // Velocity mode: to `velocity` (counts/s, signed, within limits.velocity) and on at it until another command, past
  // the end of the position range too; towards a soft limit, until it stands on that. At rest and in flight; takes over
  // and refuses as `command` does. Over the shaper's length it must stay below 2^31 counts.
  Status jog(double velocity, const AxisLimits& limits, MoveReport* report);

  // Streamed setpoints: from the next commit on every tick follows what `stream` was given last, bit for bit where that
  // keeps the limits, and before the shaper, so that what leaves is shaped; in front of a soft limit it stops. It
  // begins with a setpoint where the axis stands. `halt` ends it, and so does a fault. Refuses kBusy unless at rest
  // with nothing pending, limits above the axis's maximum or below what StreamLimits can hold, a velocity as `jog`
  // does, and kNotAvailable behind a shaper with negative gains, whose output nobody can vouch for.
  Status begin_stream(const StreamConfig& config);

  // The setpoint of the next tick. Between ticks: from the background or from the tick's own context.
  void stream(Signal setpoint);

  // Each of its own tick, not of one.
  StreamState stream_state() const;

  // To rest as soon as `limits` allow, before the shaper: so it ends still, the shaper's length later. A command that
  // waits is dropped. Where no such motion keeps the axis's own limits (soft ones, or in a blend) it becomes a quick
  // stop. Refuses only limits that are invalid or above the axis's maximum.
  Status halt(const AxisLimits& limits, MoveReport* report);

  // Changes the shaper. Refuses kBusy while something is pending, and kLineTooShort (`value` LineSamples needed, by
  // Shaper::memory_needed, `accepted` there).
  // kAtRest: refuses kBusy while the axis moves too; takes effect at the next tick that allows a commit.
  // kBlended: also while the axis moves. Looks for a stretch of what is left of the move in which going over from the
  // one shaper's output to the other's keeps the limits of the move; the new shaper then runs beside the old from the
  // next commit on and is active once the blend is over. While there is none it stays pending, `service` looks again
  // further on, and the next rest makes it active as kAtRest does: at the latest when the old shaper has drained.
  // The move then ends with the new shaper's length. A search needs the memory of both shapers in the spare's; too
  // long for that wait for rest. Cost: see BlendSearch, and 2 to 3 KB of stack.
  Status set_shaper(const ShaperDesign& design, Retune when = Retune::kAtRest);

  // Plans again what the tick missed in flight. And for a blended retune that found no room in the part of the move
  // that was searched, or whose window the tick missed: looks further, once there is further to look. Nothing breaks if
  // it is never called: the motion in force goes on, the retune waits for rest.
  void service();

  // The spare shaper's memory, for as long as nobody needs it: `doubles` of them, one a LineSample; an identification
  // works there. Null while something is pending or a blend runs. Until it is taken back a change of shaper, and moves
  // that are checked behind the shaper (zero delay, negative gains), are refused kBusy.
  double* lend_memory(size_t& doubles);
  void take_memory_back() { lent_ = false; }
  // In motion: a halt, or another change of this motion, would be checked there; it had better not be lent now.
  bool flight_needs_memory() const { return !running().averages() || terms_[active_track_].only_checked; }

  // One tick's state, never torn.
  AxisState state() const;

  // True while a command or a shaper waits for a tick that allows a commit, and until a blended shaper is active.
  bool pending() const;

  // The shaper in force (after the pending one took effect, after the blend to it): put together from what runs, so
  // keep it rather than ask twice.
  ShaperDesign shaper() const;

  const AxisConfig& config() const { return config_; }

  // What a rotary axis reads at the setpoint, to the nearest count: [0, modulo_counts). 0 for a linear one. It counts
  // from position 0 of the range at the last reset.
  int32_t reading_counts() const;

  // --- either context ---------------------------------------------------------------------------------------------

  // Quick stop: from the next tick on the output itself ramps to rest within the quick-stop limits, past the shaper,
  // whose line is then filled with where the axis stands. No commit is needed. A pending move is dropped; a pending
  // shaper stays, until the axis is at rest, and so does one that is being blended in.
  void request_stop();

  // --- tick -------------------------------------------------------------------------------------------------------

  // Advances one tick and returns the setpoint. Bounded: no division, no floating point, no error.
  // `commit` false: pending requests of the background wait.
  Signal tick(bool commit = true);

  // Puts the axis at rest at `position`, line filled, no ramp: for enabling, homing, after faults. A pending move is
  // dropped, a pending shaper stays. Only where no tick can come between: from the tick's context, or with the tick
  // off.
  void reset(Signal position);

 protected:
  void attach(LineSample* active_memory, LineSample* spare_memory, size_t line_capacity);

 private:
  // A shaper's line is filled where the axis stands, or (kLaterShaper) left to the tick that takes it at rest.
  enum Pending : uint32_t { kNothing, kShaper, kLaterShaper, kBlend };
  // kFromRest waits for a commit; kInFlight, once it has seen one, for its tick; kMissed for the background.
  enum PendingMove : uint32_t { kNoMove, kFromRest, kInFlight, kMissed, kStream };

  // What was asked for in motion, until a tick has taken it.
  struct Flight {
    Move move;
    double velocity;
    bool to_velocity;
  };
  // What is to be kept of a motion, beside its track.
  struct Terms {
    Move move;
    bool only_checked;        // the profile has been beyond its limits: only the stream that was checked keeps them
    bool may_turn;            // planned in flight: no direction is its own
    double release_jerk;      // counts/s^3: at its start an acceleration in force is let go with it
    uint32_t released_ticks;  // for so long
  };
  // What it comes to, from `start` on.
  struct Course {
    Differences start;
    Plan plan;
    Signal target;
    double cruise;  // counts/tick
    bool to_target;
    double release_jerk;  // as in Terms
    uint32_t released_ticks;
  };

  const Shaper& running() const { return shapers_[load(active_shaper_)]; }
  Status check_ready() const;
  Status check_wrap(double velocity) const;
  Status check_move(const Move& move) const;
  Status plan_at_rest(const Move& move, const AxisState& now, Signal& target, Plan& plan) const;
  Status command_in_flight(const Move& move, MoveReport* report);
  Status find_target(const Move& move, const Differences& start, Signal zero, Signal& target) const;
  Status fly(const Flight& flight, MoveReport* report);
  Status make_course(const Flight& flight, const AxisState& now, Course& course);
  Status make_checked_course(const Flight& flight, const AxisState& now, uint32_t lead, Course& course);
  Status plan_to_target(const Move& move, Signal zero, Course& course) const;
  Status plan_to_cruise(const Flight& flight, Course& course) const;
  Status check_extent(const Course& course) const;
  Status check_stream(const Flight& flight, const AxisState& now, uint32_t lead);
  void offer_blend(uint32_t epoch, const AxisState& now);
  bool find_blend(const AxisState& now);
  // move_timing.cpp
  Status time_move(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report);
  Status time_plainly(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report);
  Status time_zero_delay(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report);
  Status time_within(const Move& move, Signal start, Signal target, uint32_t ticks, Plan& plan, MoveReport& report);
  Status time_sooner(const Move& move, Signal start, Signal target, uint32_t available, Plan& plan, MoveReport& report);
  Status slow_down_for_shaper(const Move& move, Signal start, Signal target, Plan& plan, MoveReport& report);
  // axis_retune.cpp. `Source`: a design, or a shaper that runs.
  template <typename Source>
  Status configure_spare(const Source& source, Signal position);
  Status fill_spare(Signal start);
  ShapedMoveCheck check_for(const Move& move, Signal start, Signal target);
  void hand_over(Pending what, uint32_t epoch);
  void hand_over_move(PendingMove what, uint32_t epoch);

  void take_move(bool commit);
  void begin_track();
  // Weak, beside begin_stream: an image that never calls that has none of the limiter's 7 KB.
  [[gnu::weak]] void start_stream();
  [[gnu::weak]] Signal follow_stream();
  void take_pending(uint32_t what);
  void take_shaper(uint32_t what);
  void begin_blend();
  Signal blend(Signal input, Signal output);
  void end_blend();
  void drop_blend();
  void set_length(uint32_t length_ticks);
  void begin_stop();
  void rest_at(Signal position);
  Signal advance();
  void publish(Signal setpoint);

  // Set by configure, at rest, and read by the tick only to leave rest.
  AxisConfig config_ = {};
  StopLimits stop_limits_ = {};
  Signal soft_low_ = 0;
  Signal soft_high_ = 0;
  LineSample* memory_[2] = {};
  size_t capacity_ = 0;
  bool configured_ = false;

  // The mailbox. The background fills the spares, then sets pending_; the tick takes them and clears it. A stop or
  // reset in between moves epoch_ on, and what was planned before it is dropped.
  uint32_t pending_ = kNothing;
  uint32_t pending_epoch_ = 0;
  uint32_t pending_move_ = kNoMove;
  uint32_t move_epoch_ = 0;
  uint32_t flight_at_ = 0;    // the axis's tick
  uint32_t blend_begin_ = 0;  // the axis's tick
  uint32_t blend_order_ = 0;
  uint32_t looking_ = 0;  // the background has a pending shaper back for a while
  uint32_t stop_requested_ = 0;
  // Written for the stream that waits.
  StreamLimits stream_limits_ = {};
  Signal streamed_[2] = {};  // the one of the count's last bit is the newest
  uint32_t streamed_count_ = 0;
  uint32_t stream_begin_count_ = 0;  // what comes later belongs to it
  uint32_t made_up_ticks_ = 0;
  uint32_t stream_end_requested_ = 0;
  StreamPolicy stream_policy_ = StreamPolicy::kClamp;

  // The background's own.
  Flight flight_ = {};
  uint32_t flight_lead_ = 0;    // ticks from a plan in flight to where it begins
  bool look_again_ = false;     // at
  uint32_t look_again_at_ = 0;  // this tick of the axis
  uint32_t blend_lead_ = 0;     // ticks from a search to the first window it may offer
  bool lent_ = false;           // the spare shaper's memory is somebody else's

  // Pairs: the tick's is the one of this index, the other the background's spare.
  uint32_t active_track_ = 0;
  uint32_t active_shaper_ = 0;
  Track tracks_[2] = {};
  Terms terms_[2] = {};  // the background's, read and written like the tracks
  Shaper shapers_[2] = {};

  // The tick's own.
  Sampler sampler_ = {};
  StopRamp stop_ramp_ = {};
  uint64_t track_ticks_ = 0;  // since the active track began
  Turns turns_ = {};
  StreamLimiter limiter_ = {};
  bool stopping_ = false;
  bool flight_armed_ = false;  // a commit has been seen
  bool streaming_ = false;
  bool blending_ = false;  // the spare pair runs too
  uint32_t epoch_ = 0;
  uint32_t stream_seen_ = 0;  // of streamed_count_
  uint32_t limiting_ = 0;     // of its state what the background reads
  uint32_t stream_faulted_ = 0;
  uint32_t limited_ticks_ = 0;
  uint32_t length_ticks_ = 0;  // of the active shaper, in a blend of the longer
  uint32_t drain_ticks_ = 0;   // until its line holds nothing but the standing position
  uint32_t blend_wait_ = 0;    // ticks of the old output still to come
  BlendRamp blend_ramp_ = {};
  Signal outputs_[3] = {};  // newest first
  Snapshot<AxisState> published_;
};

}  // namespace stillpoint
