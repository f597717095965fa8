// SPDX-License-Identifier: Apache-2.0
// What the register map's table does not say: how the registers work together. Markdown, on standard output.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "firmware/parameters.hpp"
#include "sim/cli/json_fwd.hpp"

namespace stillpoint::cli {

// "0 off; 1 active; ..." of the values that the register may have; empty where its numbers stand for themselves.
std::string values_of(const firmware::Parameter& parameter);

// The same for programs: [{"value", "text"}, ...].
Json values_json(const firmware::Parameter& parameter);

// All fault codes, and the reasons that are the drive's own.
std::map<uint16_t, std::string> faults();
std::map<uint16_t, std::string> drive_reasons();

void print_states();
void print_values();
void print_faults();
void print_refusals();
void print_keys();

// register_windows.cpp: what is not a parameter, and the requests that reach it.
void print_requests();
void print_windows();
void print_serial_line();

}  // namespace stillpoint::cli
