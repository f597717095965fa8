// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/register_port.hpp"

#include <cstdio>

namespace stillpoint::sim {
namespace {

std::string register_name(uint16_t address) {
  char text[16];
  std::snprintf(text, sizeof text, "%04Xh", address);
  return text;
}

// The Modbus application protocol's own words.
const char* exception_text(int exception) {
  switch (exception) {
    case 1: return "no such function, a drive of this register map is accepted";
    case 2: return "no such register, or not to be read or written so, one of the map is accepted";
    case 3: return "not a value of this register, one of its range is accepted";
    case 4: return "the device failed, another try may be accepted";
    case 6: return "not now, another try later may be accepted";
    default: return "another request may be accepted";
  }
}

}  // namespace

RegisterRefusal::RegisterRefusal(uint16_t address, int exception)
    : Refusal(Refusal::Cause::kCannot, "register", register_name(address),
              "Modbus exception " + std::to_string(exception) + ": " + exception_text(exception), "client_refused"),
      address_(address),
      exception_(exception) {}

Refusal silent_register(uint16_t address, uint32_t requests, const std::string& why) {
  return Refusal(Refusal::Cause::kCannot, "register", register_name(address),
                 "no answer to " + std::to_string(requests) + " requests" + (why.empty() ? "" : " (" + why + ")") +
                     ", a drive that answers is accepted",
                 "client_silent");
}

}  // namespace stillpoint::sim
