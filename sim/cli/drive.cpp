// SPDX-License-Identifier: Apache-2.0
// `stillpoint drive PORT ...`: a drive over its serial port, a chip's or an emulated one's.
#include <fmt/format.h>

#include <memory>

#include "firmware/state_machine.hpp"
#include "sim/cli/chip_client.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/drive_commands.hpp"
#include "sim/cli/drive_files.hpp"
#include "sim/cli/drive_registers.hpp"
#include "sim/cli/drive_scope.hpp"
#include "sim/cli/drive_status.hpp"
#include "sim/cli/drive_tune.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/modbus_port.hpp"
#include "sim/cli/table.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Register;

struct DriveOptions {
  std::string port;
  std::string verb;
  std::vector<std::string> arguments;
  std::string unit = "1";
  std::string baud = "115200";
  std::string parity = "even";
  std::string stop_bits = "1";
  std::string target;
  std::string by;
  ScopeRequest scope;
  DriveTuneOptions tune;
};

constexpr char kVerbs[] = "status enable disable halt stop reset move tune scope get set save export import faults";

struct Call {
  const DriveOptions& options;
  const Output& output;
  sim::RegisterPort& port;

  int64_t value(Register name) const {
    return read_parameter(port, firmware::kParameters[firmware::find_parameter(address_of(name))]);
  }

  const std::string& argument(size_t index, const char* what) const {
    if (index < options.arguments.size()) return options.arguments[index];
    throw sim::bad_argument("argument", "missing", fmt::format("`{}` needs {}", options.verb, what));
  }
};

int show_values(const Call& call, const std::vector<std::string>& names) {
  Json values = {{"result", "ok"}};
  Table table({"register", "value", "unit"});
  for (const std::string& name : names) {
    const firmware::Parameter parameter = parameter_named(name);
    const int64_t value = read_parameter(call.port, parameter);
    values[name_of(parameter)] = value;
    table.row({name_of(parameter), std::to_string(value), firmware::text_of(parameter).unit});
  }
  if (call.output.json) {
    print_json(values);
  } else {
    table.print();
  }
  return 0;
}

int set_value(const Call& call) {
  const firmware::Parameter parameter = parameter_named(call.argument(0, "a register and a value"));
  const int64_t value = sim::parse_integer(call.argument(1, "a value"), name_of(parameter), INT32_MIN, UINT32_MAX);
  if (parameter.lock == firmware::Lock::kNeedsKey) unlock(call.port);
  write_parameter(call.port, parameter, value);
  if (parameter.readable()) return show_values(call, {call.options.arguments[0]});
  if (call.output.json) print_json({{"result", "ok"}});
  return 0;
}

MoveRequest move_request(const DriveOptions& options) {
  const bool relative = !options.by.empty();
  if (relative == !options.target.empty())
    throw sim::bad_argument("--target", "missing", "`move` needs one of --target and --by, in counts");
  const std::string& text = relative ? options.by : options.target;
  const int64_t counts = sim::parse_integer(text, relative ? "--by" : "--target", INT32_MIN, INT32_MAX);
  return {static_cast<int32_t>(counts), relative};
}

int move(const Call& call) {
  const MoveReport report = start_move(call.port, move_request(call.options));
  ChipClient(call.port).finish(report.total_ticks);
  const Json object = {{"result", "ok"},
                       {"profile_ticks", report.profile_ticks},
                       {"total_ticks", report.total_ticks},
                       {"zero_delay_met", report.zero_delay_met},
                       {"position_counts", call.value(Register::kActualPosition)}};
  if (call.output.json) {
    print_json(object);
  } else {
    fmt::print("at {} counts after {} ms, {} of them the profile's\n", object["position_counts"].get<int64_t>(),
               report.total_ticks, report.profile_ticks);
  }
  return 0;
}

// With --target or --by it makes the move that it is to see.
int scope(const Call& call) {
  check_output(call.output);
  const DriveOptions& options = call.options;
  const bool moves = !options.target.empty() || !options.by.empty();
  const MoveRequest request = moves ? move_request(options) : MoveRequest{};
  const ScopeRecord record = capture_scope(call.port, options.scope, [&] {
    if (moves) start_move(call.port, request);
  });
  if (!call.output.csv.empty()) write_scope_csv(call.output.csv, settings_of(options.scope), record);
  if (!call.output.plot.empty()) draw_scope(call.output.plot, "stillpoint drive scope", record);
  if (call.output.json) {
    print_json(json_of(record));
  } else {
    print_scope(record);
  }
  return 0;
}

int tune(const Call& call) {
  DriveTuneOptions options = call.options.tune;
  options.by = call.options.by;
  return tune_drive(call.port, options, call.output);
}

int command(const Call& call) {
  const std::string& verb = call.options.verb;
  if (verb == "status") return show_status(call.port, call.output);
  if (verb == "faults") return show_faults(call.port, call.output);
  if (verb == "get") return call.argument(0, "a register"), show_values(call, call.options.arguments);
  if (verb == "set") return set_value(call);
  if (verb == "move") return move(call);
  if (verb == "scope") return scope(call);
  if (verb == "tune") return tune(call);
  if (verb == "export") {
    const Json object = exported(call.port);
    if (call.options.arguments.empty()) return print_json(object), 0;
    write_json_file(call.options.arguments[0], object);
  } else if (verb == "import") {
    for (const std::string& told : import_settings(call.port, read_json_file(call.argument(0, "a file"))))
      fmt::print(stderr, "stillpoint: warning: {}\n", told);
  } else if (verb == "enable") {
    enable_drive(call.port);
  } else if (verb == "disable") {
    disable_drive(call.port);
  } else if (verb == "halt") {
    halt_drive(call.port);
  } else if (verb == "stop") {
    stop_drive(call.port);
  } else if (verb == "reset") {
    reset_drive(call.port);
  } else if (verb == "save") {
    save_settings(call.port);
  } else {
    throw sim::bad_argument("drive", verb, fmt::format("not known, accepted: {}", kVerbs));
  }
  return show_status(call.port, call.output);
}

char parity_of(const std::string& text) {
  if (text == "none") return 'N';
  if (text == "even") return 'E';
  if (text == "odd") return 'O';
  throw sim::bad_argument("--parity", text, "not known, accepted: none even odd");
}

int run(const DriveOptions& options, const Output& output) {
  if (options.port.empty()) throw sim::bad_argument("PORT", "missing", "`drive PORT VERB` is accepted");
  if (options.verb.empty()) throw sim::bad_argument("drive", "missing", fmt::format("accepted: {}", kVerbs));
  SerialSettings settings;
  settings.device = options.port;
  settings.baud = static_cast<int>(sim::parse_integer(options.baud, "--baud", 1200, 4000000));
  settings.unit = static_cast<int>(sim::parse_integer(options.unit, "--unit", 1, 247));
  settings.parity = parity_of(options.parity);
  settings.stop_bits = static_cast<int>(sim::parse_integer(options.stop_bits, "--stop-bits", 1, 2));
  ModbusPort port(settings);
  return command({options, output, port});
}

}  // namespace

void add_drive(Commands& commands, Output& output) {
  const auto options = std::make_shared<DriveOptions>();
  CLI::App& app = commands.add("drive", "Speaks Modbus RTU with a drive: a chip, or `emulate`.",
                               [options, &output] { return run(*options, output); });
  add_value(app, "PORT", options->port, " ", "the serial port");
  add_value(app, "VERB", options->verb, " ",
            std::string("one of: ") + kVerbs +
                "; halt ramps and holds until the next move, stop is the quick stop of 0078, disable takes the torque "
                "at once, reset ends a fault, move is in profile position mode");
  add_arguments(app, "ARGUMENTS", options->arguments,
                "get REGISTER..., set REGISTER VALUE, export [FILE], import FILE");
  add_value(app, "--unit", options->unit, "N", "the drive's address");
  add_value(app, "--baud", options->baud, "N", "bits a second");
  add_value(app, "--parity", options->parity, "none|even|odd", "of the port; a pseudo-terminal has none");
  add_value(app, "--stop-bits", options->stop_bits, "1|2", "of the port");
  add_value(app, "--target", options->target, "COUNTS", "move, scope: where to");
  add_value(app, "--by", options->by, "COUNTS|host|drive",
            "move, scope: how far from the target in force; tune: who does it, the host where the drive cannot");
  add_scope_request(app, options->scope);
  add_drive_tune_options(app, options->tune);
  add_output(app, output);
}

}  // namespace stillpoint::cli
