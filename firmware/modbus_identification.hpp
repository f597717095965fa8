// SPDX-License-Identifier: Apache-2.0
// Function 43/14, read device identification (V1.1b3, 6.21).
#pragma once

#include "firmware/modbus_pdu.hpp"

namespace stillpoint::firmware::modbus {

struct DeviceObject {
  uint8_t id;
  const char* text;  // at most kMaxPduBytes - 9 bytes: one object always fits into a response
};

// `objects` rise by id; 0 to 2 are there. Stream access gives those of the category asked for from the id asked for on,
// from the first where that is none of them, and says where to go on when they do not fit; a category that is not there
// (extended) gives the ones that are. Individual access to one that is not there: exception 02. Conformity: regular,
// stream and individual.
ModbusException read_device_identification(const DeviceObject* objects, size_t count, Exchange& exchange);

// This device's: vendor, product code, revision; product and model name.
ModbusException read_device_identification(Exchange& exchange);

}  // namespace stillpoint::firmware::modbus
