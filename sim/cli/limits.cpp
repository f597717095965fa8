// SPDX-License-Identifier: Apache-2.0
// `stillpoint limits`: the axis limits that the hardware allows.
#include <fmt/format.h>

#include <memory>

#include "shaper/profile/hardware_limits.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/table.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct Option {
  const char* name;
  const char* placeholder;
  const char* help;
  double Hardware::*member;
};

constexpr Option kOptions[] = {
    {"--motor-rpm", "RPM", "highest speed of the motor", &Hardware::motor_rpm},
    {"--gear-ratio", "N", "turns of the motor for one of the screw (default 1)", &Hardware::gear_ratio},
    {"--pitch", "M", "travel a turn of the screw, metres", &Hardware::pitch_m},
    {"--encoder-max-hz", "HZ", "bandwidth of the encoder's head", &Hardware::encoder_max_hz},
    {"--pulses-per-rev", "N", "periods of the encoder's head a turn of the motor", &Hardware::pulses_per_rev},
    {"--interpolation", "N", "factor of the interpolator (default 1)", &Hardware::interpolation},
    {"--interpolator-max-hz", "HZ", "highest frequency at the interpolator's input", &Hardware::interpolator_max_hz},
    {"--counter-max-hz", "HZ", "clock of the counter, which decodes x4", &Hardware::counter_max_hz},
    {"--torque-constant", "NM_A", "N m/A, of a motor that turns", &Hardware::torque_constant},
    {"--force-constant", "N_A", "N/A, of a linear motor", &Hardware::force_constant},
    {"--max-current", "A", "highest current", &Hardware::max_current_a},
    {"--gear-efficiency", "E", "0 to 1 (default 1)", &Hardware::gear_efficiency},
    {"--screw-efficiency", "E", "0 to 1 (default 1)", &Hardware::screw_efficiency},
    {"--friction-force", "N", "along the way", &Hardware::friction_force_n},
    {"--mass", "KG", "that is moved", &Hardware::mass_kg},
    {"--current-bandwidth", "HZ", "of the current loop (advisory jerk)", &Hardware::current_bandwidth_hz},
    {"--electrical-time", "S", "time constant L/R of the motor (advisory jerk)", &Hardware::electrical_time_s},
    {"--supply-voltage", "V", "of the amplifier (advisory jerk, with --resistance)", &Hardware::supply_voltage},
    {"--resistance", "OHM", "of the motor", &Hardware::resistance_ohm},
    {"--control-rate", "HZ", "of the control interrupt (advisory jerk)", &Hardware::control_rate_hz},
    {"--output-bandwidth", "HZ", "of the output stage (advisory jerk)", &Hardware::output_bandwidth_hz},
    {"--velocity-error-constant", "1/S", "following error = velocity / this", &Hardware::velocity_error_constant},
    {"--acceleration-error-constant", "1/S2", "and acceleration / this", &Hardware::acceleration_error_constant},
    {"--max-following-error", "M", "bound of both together, metres", &Hardware::max_following_error_m}};
constexpr size_t kOptionCount = sizeof kOptions / sizeof kOptions[0];

struct Named {
  const char* name;
  const char* unit;
  const LimitedBy& limit;
};

Json parts_of(const LimitedBy& limit) {
  Json parts = Json::object();
  for (size_t i = 0; i < limit.count; ++i) parts[text(limit.parts[i].by)] = limit.parts[i].value;
  return parts;
}

void print_as_json(const std::vector<Named>& limits) {
  Json object = {{"result", "ok"}};
  for (const Named& each : limits) {
    const bool known = each.limit.count > 0;
    object[each.name] = known ? Json(each.limit.binding().value) : Json(nullptr);
    object[std::string(each.name) + "_limited_by"] = text(each.limit.binding().by);
    object[std::string(each.name) + "_candidates"] = parts_of(each.limit);
  }
  print_json(object);
}

void print_as_table(const std::vector<Named>& limits) {
  Table table({"limit", "by", "value", "unit", ""});
  for (const Named& each : limits) {
    const LimitedBy::Part binding = each.limit.binding();
    for (size_t i = 0; i < each.limit.count; ++i) {
      const LimitedBy::Part& part = each.limit.parts[i];
      table.row({each.name, text(part.by), figure(part.value), each.unit, part.by == binding.by ? "binds" : ""});
    }
    if (each.limit.count == 0) table.row({each.name, "nothing known", "", each.unit, ""});
  }
  table.print();
  fmt::print(
      "\nThe jerk is advisory: all of the acceleration over the time that the part named takes to bring it up.\n");
}

int run(const std::vector<std::string>& texts, const Output& output) {
  Hardware hardware{};
  for (size_t i = 0; i < kOptionCount; ++i) {
    if (texts[i].empty()) continue;
    hardware.*kOptions[i].member = sim::parse_positive(texts[i], kOptions[i].name);
  }
  HardwareLimits limits{};
  sim::require(hardware_limits(hardware, limits));
  const std::vector<Named> all = {{"velocity", "m/s", limits.velocity},
                                  {"acceleration", "m/s^2", limits.acceleration},
                                  {"jerk", "m/s^3", limits.jerk}};
  if (output.json) {
    print_as_json(all);
  } else {
    print_as_table(all);
  }
  return 0;
}

}  // namespace

void add_hardware_limits(Commands& commands, Output& output) {
  const auto texts = std::make_shared<std::vector<std::string>>(kOptionCount);
  CLI::App& app = commands.add("limits", "The axis limits that the hardware allows; what is not given limits nothing.",
                               [texts, &output] { return run(*texts, output); });
  for (size_t i = 0; i < kOptionCount; ++i) {
    add_value(app, kOptions[i].name, (*texts)[i], kOptions[i].placeholder, kOptions[i].help);
  }
  add_json(app, output);
}

}  // namespace stillpoint::cli
