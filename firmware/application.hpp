// SPDX-License-Identifier: Apache-2.0
// The whole drive, without a chip: what main.cpp of a target wires to its ports.
#pragma once

#include <stdint.h>

#include "firmware/control_loop.hpp"
#include "firmware/drive.hpp"
#include "firmware/fault_log.hpp"
#include "firmware/line_settings.hpp"
#include "firmware/modbus_rtu.hpp"
#include "firmware/modbus_server.hpp"
#include "firmware/parameter_keeper.hpp"
#include "firmware/parameters.hpp"
#include "firmware/position_stream.hpp"
#include "firmware/pulse_timing.hpp"
#include "firmware/register_bank.hpp"
#include "firmware/scope.hpp"
#include "firmware/shaper_settings.hpp"
#include "firmware/tuner.hpp"
#include "hal/byte_stream.hpp"
#include "hal/nonvolatile.hpp"
#include "hal/servo_port.hpp"
#include "hal/watchdog.hpp"
#include "shaper/axis/axis_core.hpp"
#include "shaper/base/shared.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint::firmware {

struct Ports {
  hal::ServoPort* servo;
  hal::ByteStream* client;  // Modbus RTU
  hal::Watchdog* watchdog;
  FaultMemory* faults = nullptr;               // memory that a reset leaves alone; null: no history is kept
  TuneMemory* tune = nullptr;                  // null: neither auto-tune nor scope
  hal::Nonvolatile* memory = nullptr;          // for the parameters; null: they are not stored
  ParameterKeeper::Restart restart = nullptr;  // starts the chip anew; null: it cannot be
};

// A zero-initialised Application is valid storage (.bss); `begin` makes it work.
//
// Contexts. `tick` and `own_timer_tick` may interrupt `poll` at any instruction and touch the control loop, the servo
// port and the clocks here; everything else belongs to `poll`. What crosses between them crosses in the control loop
// and in the axis (see there), and in the two clocks, which are 32 bits and written by the tick's context alone.
class Application {
 public:
  // Once, before the first tick. `axis` must have been configured (Axis::configure) by then; its limits become the
  // registers', unless parameters were stored.
  void begin(AxisCore& axis, const Ports& ports);

  // After `begin`: how the client's line is to be set until the next start.
  LineSettings line() const { return line_; }

  // And the pulses of a drive with a pulse input, where the target has one.
  PulseRatio pulse_ratio() const { return pulse_ratio_; }

  // Tick context: once a servo tick (the sync of the servo link, or the chip's timer where the port has no sync).
  void tick();

  // Interrupt context, same priority as `tick`: once a millisecond of the chip's own timer, whether or not ticks come.
  void own_timer_tick();

  // Tick context, after a `tick` that had not ended when the next was due.
  void note_overrun() { loop_.note_overrun(); }

  // Any context: a fault that only the target can see (the watchdog's reset, the stack's guard).
  void note_fault(FaultCode fault) { loop_.request_fault(fault); }

  // Background: for ever, as often as possible. Bounded; long while it plans (see AxisCore::command), designs (see
  // add_shaper) and identifies (see identify), but in the last two the client is answered meanwhile, the drive's state
  // kept and the watchdog fed.
  void poll();

  // Background, for a target's own displays and for tests.
  const Drive& drive() const { return drive_; }
  const TuneReport& tuning() const { return tuner_.report(); }
  const RtuCounters& client_counters() const { return client_.counters(); }

 private:
  static void advance(uint32_t& word) { store(word, word + 1); }

  // All of `poll` that is short; also while a design or an identification runs.
  void serve();
  static void serve_meanwhile(void* application);
  void feed_watchdog(uint32_t now);

  Ports ports_ = {};
  AxisCore* axis_ = nullptr;
  ControlLoop loop_ = {};
  Drive drive_ = {};
  ShaperSettings shaper_ = {};
  Tuner tuner_ = {};
  Scope scope_ = {};
  Parameters parameters_ = {};
  FaultLog faults_ = {};
  PositionStream stream_ = {};
  RegisterBank registers_ = {};
  ParameterKeeper keeper_ = {};
  RtuPort client_ = {};
  ModbusServer server_ = {};
  LineSettings line_ = {};
  PulseRatio pulse_ratio_ = {};

  // The tick context's. silence_clock_ runs with the control ticks, and with the own timer while there are none, so
  // that a client is heard before the servo link is up.
  uint32_t silence_clock_ = 0;
  uint32_t uptime_ms_ = 0;
  bool ticked_ = false;

  uint32_t fed_at_ = 0;
};

}  // namespace stillpoint::firmware
