// SPDX-License-Identifier: Apache-2.0
// The register map as Modbus sees it: the parameters, checked by their table, with what a write sets off.
#pragma once

#include <stdint.h>

#include "firmware/drive.hpp"
#include "firmware/fault_log.hpp"
#include "firmware/modbus_pdu.hpp"
#include "firmware/parameters.hpp"
#include "firmware/position_stream.hpp"
#include "firmware/scope.hpp"
#include "firmware/shaper_settings.hpp"
#include "firmware/tuner.hpp"
#include "shaper/axis/axis_core.hpp"

namespace stillpoint::firmware {

class ParameterKeeper;

constexpr uint32_t kUnlockedMs = 60000;

// Background. Zero-initialised storage is valid.
//
// A write checks, in this order, each over the whole request before the next: every address (02), every value (03),
// every lock and state (06). Then all of it is committed, in order of address, but for
// the shaper set (0101), which goes first. A 32-bit value is written whole or not
// at all. 06 leaves its reason in 0012 and the register in 0013; a value out of range leaves the nearest accepted one
// in 0016.
class RegisterBank {
 public:
  struct Parts {
    AxisCore* axis;
    ControlLoop* loop;
    Drive* drive;
    ShaperSettings* shaper;
    Tuner* tuner;
    Parameters* parameters;
    const FaultLog* faults;
    PositionStream* stream;
    Scope* scope;
    ParameterKeeper* keeper;
  };

  void begin(const Parts& parts);

  // Makes the parameters, which came from elsewhere than a write, the axis's and the loop's. As the axis refuses them,
  // and then nothing has changed.
  Status take_parameters();
  // The loop's alone.
  void watch();

  // Once a poll, before requests: the own clock, which the unlock key's time runs on.
  void set_uptime(uint32_t uptime_ms);

  // Everything read in one request belongs to one tick, the one that Drive::service saw last. Write-only registers
  // read 0. The scope's window is refused with 06 until its record is full; 0301 says what it is at, 0012 stays.
  ModbusException read(uint16_t first, uint32_t count, uint16_t* words);
  ModbusException write(uint16_t first, uint32_t count, const uint16_t* words);

  // A write between that keeps the record that a read of `first` needs; 06 if it cannot.
  void keep_record(bool keep) { keeps_record_ = keep; }

  // A write that every drive on the line was told. It can stop motion and never start it: a controlword may not ask for
  // a set-point, nor for operation unless it is enabled already and is halted; while it is enabled nothing else may be
  // written at all. Refused with 06.
  ModbusException write_from_all(uint16_t first, uint32_t count, const uint16_t* words);

  // 06, as a state refuses a write, unless the drive is disabled (see ParameterKeeper).
  ModbusException check_disabled();

  uint32_t ticks_per_second() const { return ticks_per_second_; }

 private:
  struct Request;

  ModbusException write_stream(const Request& request);
  uint32_t ticks_of(uint32_t ms) const;
  uint32_t most_per_tick(uint32_t velocity) const;
  uint16_t word_at(uint16_t address) const;
  void refresh();
  void refresh_motion(const LoopSnapshot& loop);
  ModbusException check_addresses(const Request& request) const;
  ModbusException check_values(const Request& request);
  ModbusException check_state(const Request& request);
  ModbusException refuse_state(uint16_t reason, Register culprit);
  uint16_t key_refusal(uint32_t key) const;
  uint32_t staged(const Request& request, Register name) const;
  uint32_t staged_under_ceiling(const Request& request, Register name) const;
  ModbusException check_limits(const Request& request, Register culprit);
  Status configure_axis(const Request& request);
  ModbusException do_commands(const Request& request);
  void commit(const Request& request);
  void set_off(const Parameter& parameter, uint32_t value);

  Parts parts_ = {};
  uint32_t ticks_per_second_ = 0;
  uint32_t uptime_ms_ = 0;
  uint32_t unlocked_at_ms_ = 0;
  bool unlocked_ = false;
  bool keeps_record_ = false;
};

}  // namespace stillpoint::firmware
