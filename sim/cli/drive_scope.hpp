// SPDX-License-Identifier: Apache-2.0
// A drive's scope, from a Modbus client's side (registers 0300 on).
#pragma once

#include <functional>
#include <string>

#include "sim/cli/command.hpp"
#include "sim/cli/scope_record.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

struct ScopeRequest {
  std::string channels = "setpoint,position,following-error,accelerometer";
  std::string trigger = "motion";
  std::string level = "0";
  std::string edge = "rising";
  std::string pre_percent = "10";
  std::string decimation = "1";
  std::string timeout = "60";
};
void add_scope_request(CLI::App& app, ScopeRequest& request);

// Arms, calls `armed`, waits for the trigger and the end of the record, and fetches it. The level is of the first
// channel. Refuses by the option's name before the drive is spoken to; `not_triggered` where nothing has come within
// the timeout; and what the drive refuses, with its reason. `meanwhile` (may be empty) is called while it waits, and
// nothing is shown then. Whatever is thrown from `armed` on, by the two functions too, leaves the scope stopped.
ScopeRecord capture_scope(sim::RegisterPort& port, const ScopeRequest& request, const std::function<void()>& armed,
                          const std::function<void()>& meanwhile = {});
// Gives the scope's memory back to the drive, and the record up.
void stop_scope(sim::RegisterPort& port);

// Of the request, for the head of a CSV file.
Settings settings_of(const ScopeRequest& request);

}  // namespace stillpoint::cli
