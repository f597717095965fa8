// SPDX-License-Identifier: Apache-2.0
// `stillpoint emulate`: a drive behind a serial port, without a drive: the firmware on the host, or the chip's own
// image in the emulator, with the simulated arm.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "sim/cli/command.hpp"
#include "sim/cli/emulated_drive.hpp"
#include "sim/cli/page_file.hpp"
#include "sim/hil/pseudo_terminal.hpp"
#include "sim/refusal.hpp"
#include "sim/simulated_drive.hpp"
#include "sim/spec.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct EmulateOptions {
  std::string elf;
  std::string arm = "11:0.11";
  std::string counts_per_unit = "1000000";
  std::string link;
  std::string seconds = "0";
  std::string memory;
};

volatile std::sig_atomic_t told_to_end = 0;

void end_politely(int) { told_to_end = 1; }

// A name of the user's own for a port that has another each time.
class Link {
 public:
  Link(const std::string& name, const std::string& path) : name_(name) {
    if (name_.empty()) return;
    std::error_code error;
    if (std::filesystem::is_symlink(name_, error)) std::filesystem::remove(name_, error);
    std::filesystem::create_symlink(path, name_, error);
    if (error)
      throw sim::bad_argument("--link", name_, "cannot be made (" + error.message() + "), a new name is accepted");
  }
  ~Link() {
    std::error_code error;
    if (!name_.empty()) std::filesystem::remove(name_, error);
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

 private:
  std::string name_;
};

int run(const EmulateOptions& options) {
  sim::SimulatedDriveConfig config;
  config.modes = sim::parse_arm(options.arm);
  config.counts_per_unit = sim::parse_positive(options.counts_per_unit, "--counts-per-unit");
  const double seconds = sim::parse_number(options.seconds, "--seconds");
  sim::SimulatedDrive drive(config);
  sim::PseudoTerminal client;
  std::unique_ptr<PageFile> memory;
  if (!options.memory.empty()) memory = std::make_unique<PageFile>(options.memory);
  const std::unique_ptr<EmulatedDrive> steps = options.elf.empty()
                                                   ? firmware_on_host(drive, client, memory.get())
                                                   : firmware_on_chip(options.elf, drive, client, memory.get());
  // The port is shown once the drive hears what comes in.
  constexpr int kStepsToBoot = 100;
  for (int i = 0; i < kStepsToBoot; ++i) steps->step();
  const Link link(options.link, client.path());
  std::signal(SIGINT, end_politely);
  std::signal(SIGTERM, end_politely);
  std::printf("%s\n", options.link.empty() ? client.path().c_str() : options.link.c_str());
  std::fflush(stdout);
  const Clock::time_point begun = Clock::now();
  Clock::time_point next = begun;
  while (told_to_end == 0) {
    steps->step();
    client.flush();
    next += std::chrono::milliseconds(1);
    // After a pause of this process the drive goes on from now; it does not catch up.
    if (next < Clock::now()) next = Clock::now();
    std::this_thread::sleep_until(next);
    if (seconds > 0.0 && Clock::now() - begun > std::chrono::duration<double>(seconds)) break;
  }
  return 0;
}

}  // namespace

void add_emulate(Commands& commands) {
  const auto options = std::make_shared<EmulateOptions>();
  CLI::App& app =
      commands.add("emulate", "A drive behind a serial port, whose name it prints, until it is told to end.",
                   [options] { return run(*options); });
  add_value(app, "--elf", options->elf, "FILE", "the firmware in the emulator; without it, the firmware on this host");
  add_value(app, "--arm", options->arm, "F:Z[:SHARE][,...]",
            "the simulated arm: frequency in Hz, damping ratio, share");
  add_value(app, "--counts-per-unit", options->counts_per_unit, "N", "drive counts a unit");
  add_value(app, "--link", options->link, "PATH", "a name to give the port");
  add_value(app, "--memory", options->memory, "FILE",
            "the parameters that it starts on; the firmware on this host saves them there, the emulated chip cannot");
  add_value(app, "--seconds", options->seconds, "T", "end by itself after T s; 0: never");
}

}  // namespace stillpoint::cli
