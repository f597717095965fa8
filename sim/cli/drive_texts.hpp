// SPDX-License-Identifier: Apache-2.0
// What the drive's codes say, in words.
#pragma once

#include <cstdint>
#include <string>

namespace stillpoint::cli {

std::string hexadecimal(uint16_t value);  // "0060h"

// Of 0010 and the fault history; "none" for 0, "not known" for a code of another firmware.
const char* text_of_fault(uint16_t code);

// Of 0012, with what would be accepted where the reason alone says that; "none" for 0.
std::string text_of_reason(uint16_t reason);
// Its own value is what says what would be accepted (0016).
bool names_a_value(uint16_t reason);

}  // namespace stillpoint::cli
