// SPDX-License-Identifier: Apache-2.0
// What the register map says of the drive's faults beside their names (sim/cli/drive_texts.hpp), and of its bits.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/registers.hpp"

namespace stillpoint::sim {

struct FaultText {
  std::string seen;  // when it is raised
  std::string reaction;
  const char* reset;
};
FaultText fault_text(firmware::FaultCode code);

// Of one bit, as its mask; null where it means nothing. Of 0011; of the scope's flags; of the controlword from bit 4 on
// and of the statusword's that are not the state's.
const char* warning_text(uint32_t mask);
const char* scope_flag_text(uint32_t mask);
const char* control_text(uint32_t mask);
const char* status_text(uint32_t mask);

}  // namespace stillpoint::sim
