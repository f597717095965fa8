// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "firmware/parameters.hpp"
#include "firmware/register_units.hpp"
#include "sim/cli/drive_commands.hpp"
#include "sim/cli/host_tune.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/progress.hpp"
#include "sim/cli/tune_client.hpp"
#include "sim/cli/tune_output.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

using firmware::TuneCommand;

volatile std::sig_atomic_t told_to_end = 0;
void end_politely(int) { told_to_end = 1; }

// Until it is gone a Ctrl-C is only noted.
class Interruptible {
 public:
  Interruptible() : before_(std::signal(SIGINT, end_politely)) { told_to_end = 0; }
  ~Interruptible() { std::signal(SIGINT, before_); }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  void (*before_)(int);
};

uint32_t counts_of(const std::string& text, const char* option) {
  return static_cast<uint32_t>(sim::parse_integer(text, option, 1, UINT32_MAX));
}

void take_options(const DriveTuneOptions& options, TuneRegisters& registers) {
  if (!options.excitation.empty()) registers.excitation = static_cast<uint16_t>(excitation_of(options.excitation));
  if (!options.source.empty()) registers.source = static_cast<uint16_t>(source_of(options.source));
  if (!options.amplitude.empty()) registers.amplitude = counts_of(options.amplitude, "--amplitude");
  if (!options.travel.empty()) registers.travel = counts_of(options.travel, "--travel");
  if (!options.band.empty()) {
    const auto [low, high] = band_of(options.band, 400.0);
    registers.band_low = static_cast<uint16_t>(std::lround(firmware::kBandPerHz * low));
    registers.band_high = static_cast<uint16_t>(std::lround(firmware::kBandPerHz * high));
  }
  if (!options.tolerance.empty()) {
    registers.tolerance = static_cast<uint16_t>(
        std::lround(firmware::kResidualPerOne * sim::parse_within(options.tolerance, "--tolerance", 0.001, 0.2)));
  }
}

void show(const Announcement& told, bool json) {
  std::FILE* out = json ? stderr : stdout;
  fmt::print(out, "will move at most {} counts either way so far, {} counts/s, {} counts/s^2, for {} s\n", told.travel,
             told.velocity, told.acceleration, told.duration_s);
  std::fflush(out);
}

void heed_the_end() {
  if (told_to_end == 0) return;
  throw sim::Refusal(sim::Refusal::Cause::kCannot, "tune", "interrupted",
                     "the axis stops and has its shaper of before, a tuning that may end is accepted", "interrupted");
}

TuneState run_watched(TuneClient& client, bool propose) {
  Progress progress("tuning on the drive");
  return client.run([&](TuneState state, double part_done) {
    progress.update(part_done);
    heed_the_end();
    if (state != TuneState::kProposed) return false;
    if (!propose) client.command(TuneCommand::kAccept);
    return propose;
  });
}

// Waits for the end, so that the axis stands.
void abort(TuneClient& client) {
  client.command(TuneCommand::kAbort);
  client.run([](TuneState, double) { return false; });
}

void abort_if_it_hears(TuneClient& client) {
  try {
    abort(client);
  } catch (const sim::Refusal&) {  // a drive in a fault has ended it, one that is silent stops by its own watch
  }
}

// Whatever ends this process's part leaves no drive tuning on by itself.
template <typename Run>
TuneState or_abort(TuneClient& client, const Run& run) {
  try {
    return run();
  } catch (const sim::Refusal&) {
    abort_if_it_hears(client);
    throw;
  }
}

struct Result {
  const char* by;
  Announcement first_announced;
  TuneReport report;
  std::vector<sim::SpecifiedShaper> shapers;

  bool proposed() const { return report.state == TuneState::kProposed; }
};

Json json_of_result(const Result& result) {
  const std::string word = result.proposed() ? "proposed" : result_of(result.report);
  Json object = {{"result", word}, {"by", result.by}};
  object.update(json_of(result.report));
  // No register has them, and nothing that a scope could tell them by.
  object["flaws"].erase("overruns");
  object["first_announced"] = json_of(result.first_announced);
  if (!result.shapers.empty()) object["shaper"] = sim::spec_text(result.shapers);
  return object;
}

void print_result(const Result& result) {
  const TuneReport& report = result.report;
  print_report(report, kCounts);
  if (result.proposed()) {
    fmt::print("\nproposed: residual at most {:.2f} %, delay {} s, length {} s; nothing is kept\n",
               100.0 * report.proposal.residual, report.proposal.delay_s, report.proposal.length_s);
  }
  print_proposal(report, result.shapers, kCounts);
}

// A tuning that has been started.
Result follow_drive(TuneClient& client, bool propose, bool json) {
  Result result{"drive", {}, {}, {}};
  const TuneState state = or_abort(client, [&] {
    result.first_announced = client.announced();
    show(result.first_announced, json);
    return run_watched(client, propose);
  });
  result.report = client.report();
  if (state == TuneState::kProposed) abort(client);
  if (state == TuneState::kKept) result.shapers = client.shapers();
  return result;
}

Result tune_from_here(sim::RegisterPort& port, const TuneRegisters& registers, bool propose, bool json) {
  Result result{"host", {}, {}, {}};
  Progress progress("tuning from the host");
  HostTuneTask task{registers, propose, {}, {}};
  task.announced = [&](const Announcement& told) {
    result.first_announced = told;
    show(told, json);
  };
  task.meanwhile = [&](double part_done) {
    progress.update(part_done);
    heed_the_end();
  };
  const HostTuning tuning = tune_by_host(port, task);
  result.report = tuning.report;
  result.shapers = tuning.shapers;
  return result;
}

bool is_one_of(const std::string& text, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

// False where the drive has no tuner and nobody said that it must be the drive.
bool start_on_drive(TuneClient& client, const TuneRegisters& registers, const DriveTuneOptions& options, bool json) {
  try {
    client.start(registers);
    return true;
  } catch (const sim::Refusal& refusal) {
    // One that was refused may be somebody else's tuning; one whose answer was lost may have begun.
    if (refusal.result() == "client_silent") abort_if_it_hears(client);
    if (refusal.result() != "drive_refused" || !options.by.empty() || !client.has_no_tuner()) throw;
  }
  fmt::print(json ? stderr : stdout, "the drive has no tuner: the host tunes it, by its scope\n");
  return false;
}

}  // namespace

void add_drive_tune_options(CLI::App& app, DriveTuneOptions& options) {
  add_value(app, "--excitation", options.excitation, "KIND", "tune: auto, move, bump, stepped-sine, chirp");
  add_value(app, "--source", options.source, "SENSOR", "tune: auto, accelerometer, following-error");
  add_value(app, "--amplitude", options.amplitude, "COUNTS", "tune: how far the excitation goes");
  add_value(app, "--travel", options.travel, "COUNTS", "tune: room either way of the start");
  add_value(app, "--band", options.band, "LO:HI", "tune: where modes are looked for [Hz]");
  add_value(app, "--tolerance", options.tolerance, "V", "tune: residual tolerated");
  add_flag(app, "--propose", options.propose, "tune: end with the proposal, keep nothing; without it, it is accepted");
}

int tune_drive(sim::RegisterPort& port, const DriveTuneOptions& options, const Output& output) {
  if (!is_one_of(options.by, {"", "host", "drive"}))
    throw sim::bad_argument("--by", options.by, "nobody who tunes, host and drive are accepted");
  TuneClient client(port);
  TuneRegisters registers = client.registers();
  take_options(options, registers);
  if (options.by == "host") check_host_can(registers);
  refuse_unless_ready_to_move(port);
  client.client().enable();
  const Interruptible interruptible;
  const bool by_drive = options.by != "host" && start_on_drive(client, registers, options, output.json);
  const Result result = by_drive ? follow_drive(client, options.propose, output.json)
                                 : tune_from_here(port, registers, options.propose, output.json);
  if (output.json) {
    print_json(json_of_result(result));
  } else {
    print_result(result);
  }
  return result.proposed() || result.report.state == TuneState::kKept ? 0 : exit_code_of_failure(result.report);
}

}  // namespace stillpoint::cli
