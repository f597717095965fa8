// SPDX-License-Identifier: Apache-2.0
#include "firmware/modbus_identification.hpp"

#include "firmware/registers.hpp"

namespace stillpoint::firmware::modbus {
namespace {

constexpr uint8_t kReadDeviceId = 14;
constexpr uint8_t kBasic = 1;
constexpr uint8_t kExtended = 3;
constexpr uint8_t kIndividual = 4;
constexpr uint8_t kLastOfBasic = 2;
constexpr uint8_t kConformity = 0x82;
constexpr uint8_t kMoreFollows = 0xFF;
constexpr size_t kHeaderBytes = 7;

static_assert(kFirmwareVersion == 0x0001 && kProduct == 0x5350, "the texts say the same");
constexpr DeviceObject kObjects[] = {
    {0, "stillpoint"}, {1, "SP"}, {2, "0.1"}, {4, "stillpoint drive"}, {5, "one axis, shaped"}};
constexpr size_t kObjectCount = sizeof kObjects / sizeof kObjects[0];

// False, and nothing is written, where the object does not fit.
bool append(Exchange& exchange, const DeviceObject& object) {
  size_t bytes = 0;
  while (object.text[bytes] != '\0') ++bytes;
  if (exchange.written + 2 + bytes > kMaxPduBytes) return false;
  uint8_t* to = exchange.response + exchange.written;
  to[0] = object.id;
  to[1] = static_cast<uint8_t>(bytes);
  for (size_t i = 0; i < bytes; ++i) to[2 + i] = static_cast<uint8_t>(object.text[i]);
  exchange.written += 2 + bytes;
  return true;
}

size_t find(const DeviceObject* objects, size_t count, uint8_t id) {
  size_t i = 0;
  while (i < count && objects[i].id != id) ++i;
  return i;
}

}  // namespace

ModbusException read_device_identification(const DeviceObject* objects, size_t count, Exchange& exchange) {
  const uint8_t* request = exchange.request;
  if (exchange.length < 2) return ModbusException::kIllegalValue;
  if (request[1] != kReadDeviceId) return ModbusException::kIllegalFunction;
  if (exchange.length != 4) return ModbusException::kIllegalValue;
  const uint8_t code = request[2];
  if (code < kBasic || code > kIndividual) return ModbusException::kIllegalValue;
  static_assert(kExtended < kIndividual, "the codes between them are the categories");
  const bool single = code == kIndividual;
  while (code == kBasic && count > 0 && objects[count - 1].id > kLastOfBasic) --count;
  size_t first = find(objects, count, request[3]);
  if (first == count && single) return ModbusException::kIllegalAddress;
  if (first == count) first = 0;
  uint8_t* response = exchange.response;
  for (size_t i = 0; i < 3; ++i) response[i] = request[i];
  response[3] = kConformity;
  exchange.written = kHeaderBytes;
  size_t next = first;
  const size_t end = single ? first + 1 : count;
  while (next < end && append(exchange, objects[next])) ++next;
  response[4] = next < end ? kMoreFollows : 0;
  response[5] = next < end ? objects[next].id : 0;
  response[6] = static_cast<uint8_t>(next - first);
  return ModbusException::kNone;
}

ModbusException read_device_identification(Exchange& exchange) {
  return read_device_identification(kObjects, kObjectCount, exchange);
}

}  // namespace stillpoint::firmware::modbus
