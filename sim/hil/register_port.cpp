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

}  // namespace

Refusal refused_register(uint16_t address, int exception) {
  return Refusal(Refusal::Cause::kCannot, "register", register_name(address),
                 "the drive refused with Modbus exception " + std::to_string(exception) +
                     ", registers 0012h and 0013h name what would be accepted",
                 "client_refused");
}

Refusal silent_register(uint16_t address, uint32_t requests, const std::string& why) {
  return Refusal(Refusal::Cause::kCannot, "register", register_name(address),
                 "no answer to " + std::to_string(requests) + " requests" + (why.empty() ? "" : " (" + why + ")") +
                     ", a drive that answers is accepted",
                 "client_silent");
}

}  // namespace stillpoint::sim
