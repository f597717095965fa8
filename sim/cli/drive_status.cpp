// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_status.hpp"

#include <fmt/format.h>

#include "firmware/fault_log.hpp"
#include "firmware/registers.hpp"
#include "firmware/state_machine.hpp"
#include "sim/cli/drive_registers.hpp"
#include "sim/cli/drive_state.hpp"
#include "sim/cli/drive_texts.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/table.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Register;

constexpr uint16_t kEntryWords = 8;
constexpr double kMsPerSecond = 1000.0;

std::string last_refusal(sim::RegisterPort& port) {
  const std::vector<uint16_t> refusal = port.read(address_of(Register::kRefusalReason), 2);
  if (refusal[0] == 0) return text_of_reason(0);
  return fmt::format("register {}: {}", hexadecimal(refusal[1]), text_of_reason(refusal[0]));
}

Json json_of(const FaultRecord& fault) {
  return {{"code", fault.code},
          {"text", text_of_fault(fault.code)},
          {"count", fault.count},
          {"uptime_ms", fault.uptime_ms},
          {"position_counts", fault.position_counts},
          {"demand_counts", fault.demand_counts}};
}

}  // namespace

int show_status(sim::RegisterPort& port, const Output& output) {
  const auto word = [&](Register name) { return port.read(address_of(name), 1)[0]; };
  const auto value = [&](Register name) {
    return read_parameter(port, firmware::kParameters[firmware::find_parameter(address_of(name))]);
  };
  const uint16_t statusword = word(Register::kStatusword);
  const uint16_t fault = word(Register::kErrorCode);
  const Json object = {
      {"result", "ok"},
      {"state", text(state_of(statusword))},
      {"statusword", statusword},
      {"target_reached", (statusword & firmware::kStatusTargetReached) != 0},
      {"error_code", fault},
      {"fault", text_of_fault(fault)},
      {"warnings", word(Register::kWarnings)},
      {"last_refusal", last_refusal(port)},
      {"mode", value(Register::kModeDisplay)},
      {"position_counts", value(Register::kActualPosition)},
      {"demand_counts", value(Register::kDemandAfterShaping)},
      {"following_error_counts", value(Register::kFollowingError)},
      {"velocity_counts_per_s", value(Register::kActualVelocity)},
      {"shaper_state", word(Register::kShaperState)},
      {"shaper_delay_us", value(Register::kActiveDelayUs)},
      {"uptime_ms", value(Register::kUptimeMs)},
  };
  if (output.json) {
    print_json(object);
    return 0;
  }
  Table table({"", "value"});
  for (const auto& [name, shown] : object.items()) {
    if (name == "error_code") {
      table.row({name, hexadecimal(fault)});
    } else if (name != "result") {
      table.row({name, shown.is_string() ? shown.get<std::string>() : shown.dump()});
    }
  }
  table.print();
  return 0;
}

std::vector<FaultRecord> fault_history(sim::RegisterPort& port) {
  std::vector<FaultRecord> history;
  for (size_t age = 0; age < firmware::kFaultEntries; ++age) {
    const auto address = static_cast<uint16_t>(firmware::kFirstFaultEntry + firmware::kFaultEntryStride * age);
    const std::vector<uint16_t> words = port.read(address, kEntryWords);
    if (words[0] == 0) break;
    const auto wide = [&](size_t at) { return uint32_t{words[at]} << 16 | words[at + 1]; };
    history.push_back({words[0], words[1], wide(2), static_cast<int32_t>(wide(4)), static_cast<int32_t>(wide(6))});
  }
  return history;
}

int show_faults(sim::RegisterPort& port, const Output& output) {
  const std::vector<FaultRecord> history = fault_history(port);
  if (output.json) {
    Json faults = Json::array();
    for (const FaultRecord& fault : history) faults.push_back(json_of(fault));
    print_json({{"result", "ok"}, {"faults", faults}});
    return 0;
  }
  if (history.empty()) {
    fmt::print("no faults since the history was empty\n");
    return 0;
  }
  Table table({"after its start [s]", "code", "fault", "count", "position", "demand"});
  for (const FaultRecord& fault : history) {
    table.row({fmt::format("{:.3f}", fault.uptime_ms / kMsPerSecond), hexadecimal(fault.code),
               text_of_fault(fault.code), std::to_string(fault.count), std::to_string(fault.position_counts),
               std::to_string(fault.demand_counts)});
  }
  table.print();
  return 0;
}

}  // namespace stillpoint::cli
