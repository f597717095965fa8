// SPDX-License-Identifier: Apache-2.0
// qemu-system-arm as a child process.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "sim/hil/file_descriptor.hpp"

namespace stillpoint::sim {

constexpr const char* kEmulatorProgram = "qemu-system-arm";

// What the emulator's clock does.
struct EmulatorClock {
  // Absent: it is the host's. Otherwise every instruction takes 2^shift ns of it, and it stands while the guest waits
  // for a semihosting call. 3 is about the STM32F405's pace (8 ns at 168 MHz: 1.3 cycles an instruction); 0 counts
  // instructions in timers that run at 1 GHz.
  std::optional<int> instruction_shift;
};

// How long the host waits for any one answer. Far above what a loaded machine needs.
constexpr std::chrono::seconds kEmulatorPatience{20};

// Runs until it is destroyed, or this process ends, however it ends, or the chip is reset: there is no second start.
// Linux only. Nothing is left behind: serial lines are socket pairs that the child inherits, without names.
class Emulator {
 public:
  struct Options {
    std::string elf;
    EmulatorClock clock;
    std::vector<std::string> arguments;  // further ones
    std::vector<int> inherited;          // descriptors the child keeps, under their numbers
    std::string directory;               // to run in; empty: this process's
  };

  // Throws a Refusal when there is no emulator or the image is not readable.
  explicit Emulator(const Options& options);
  ~Emulator();
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;

  // Waits until `fd` can be read. Throws a Refusal that says why not: the emulator has ended (with what it said last),
  // or nothing came within kEmulatorPatience. `waiting_for` names it.
  void wait_readable(int fd, const std::string& waiting_for);
  // The same, false after `patience`.
  bool wait_readable_for(int fd, std::chrono::milliseconds patience);

  bool ended() const;
  // Throws the Refusal that nothing came.
  [[noreturn]] void refuse_silent(const std::string& waiting_for);
  // For a descriptor whose other end has been closed: `chip_reset`, else `emulator_ended`.
  [[noreturn]] void refuse_ended();

 private:
  void kill_and_wait();
  std::string last_words();

  FileDescriptor messages_;  // the child's standard error
  pid_t child_ = -1;
};

// A connected pair; the first end does not survive an exec.
struct SocketPair {
  SocketPair();
  FileDescriptor ours;
  FileDescriptor theirs;
};

}  // namespace stillpoint::sim
