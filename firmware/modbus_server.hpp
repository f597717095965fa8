// SPDX-License-Identifier: Apache-2.0
// The Modbus slave: functions 3, 4, 6, 8, 16, 22, 23 and 43/14 on the register bank.
#pragma once

#include "firmware/modbus_diagnostics.hpp"
#include "firmware/modbus_pdu.hpp"
#include "firmware/modbus_rtu.hpp"
#include "firmware/register_bank.hpp"

namespace stillpoint::firmware {

// Background. Zero-initialised storage is valid.
//
// Exceptions in the specification's order: the function (01), quantities and lengths (03), every address (02), every
// value (03), then lock and state (06); see RegisterBank. Function 23 writes before it reads and writes nothing unless
// it can read too; 22 is a read and a write of one register with nothing between. Broadcasts are executed as far as
// RegisterBank::write_from_all lets them. Listening only (8/4) is refused with 06 unless the drive is disabled.
class ModbusServer {
 public:
  void begin(RegisterBank& registers) { registers_ = &registers; }

  // Executes the request that `line` holds and replies to it. False: it was only listened to (8/4), which is no sign
  // that anybody is in control.
  bool serve(RtuPort& line);

 private:
  ModbusException execute(const RtuPort& line, modbus::Exchange& exchange);
  ModbusException diagnose(const RtuPort& line, modbus::Exchange& exchange);
  ModbusException read(modbus::Exchange& exchange);
  ModbusException write_single(modbus::Exchange& exchange);
  ModbusException write_multiple(modbus::Exchange& exchange);
  ModbusException mask_write(modbus::Exchange& exchange);
  ModbusException read_write(modbus::Exchange& exchange);
  ModbusException write(uint16_t first, uint32_t count, const uint8_t* bytes, uint16_t* words);

  RegisterBank* registers_ = nullptr;
  modbus::Diagnostics diagnostics_ = {};
  bool to_all_ = false;
};

}  // namespace stillpoint::firmware
