// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/emulator.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void refuse(const std::string& value, const std::string& why, const std::string& result) {
  throw Refusal(Refusal::Cause::kCannot, "emulator", value, why, result);
}

std::vector<std::string> command_line(const Emulator::Options& options) {
  std::vector<std::string> words = {kEmulatorProgram, "-M",          "netduinoplus2", "-kernel",
                                    options.elf,      "-display",    "none",          "-monitor",
                                    "none",           "-nodefaults", "-no-reboot"};
  if (options.clock.instruction_shift) {
    words.insert(words.end(),
                 {"-icount", "shift=" + std::to_string(*options.clock.instruction_shift) + ",sleep=off,align=off"});
  }
  words.insert(words.end(), options.arguments.begin(), options.arguments.end());
  return words;
}

// In the child, where only async-signal-safe calls are allowed.
[[noreturn]] void become(char* const* words, const Emulator::Options& options, int messages, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it died before the line above
  ::dup2(messages, STDERR_FILENO);
  const int null = ::open("/dev/null", O_RDWR);
  ::dup2(null, STDIN_FILENO);
  ::dup2(null, STDOUT_FILENO);
  for (const int fd : options.inherited) ::fcntl(fd, F_SETFD, 0);
  if (!options.directory.empty() && ::chdir(options.directory.c_str()) != 0) ::_exit(127);
  ::execvp(words[0], words);
  const char* why = std::strerror(errno);
  static_cast<void>(!::write(STDERR_FILENO, why, std::strlen(why)));
  ::_exit(127);
}

}  // namespace

SocketPair::SocketPair() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    refuse("socketpair", std::strerror(errno), "emulator_failed");
  }
  ours = FileDescriptor(ends[0]);
  theirs = FileDescriptor(ends[1]);
}

Emulator::Emulator(const Options& options) {
  if (::access(options.elf.c_str(), R_OK) != 0) {
    throw bad_argument("elf", options.elf,
                       std::string(std::strerror(errno)) + ", a readable firmware image is accepted");
  }
  std::vector<std::string> words = command_line(options);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) refuse("pipe", std::strerror(errno), "emulator_failed");
  messages_ = FileDescriptor(ends[0]);
  const FileDescriptor theirs(ends[1]);
  const pid_t parent = ::getpid();
  child_ = ::fork();
  if (child_ < 0) refuse("fork", std::strerror(errno), "emulator_failed");
  if (child_ == 0) become(pointers.data(), options, theirs.get(), parent);
}

Emulator::~Emulator() { kill_and_wait(); }

void Emulator::kill_and_wait() {
  if (child_ <= 0) return;
  ::kill(child_, SIGKILL);
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
}

std::string Emulator::last_words() {
  std::string text;
  char buffer[512];
  for (;;) {
    const ssize_t got = ::read(messages_.get(), buffer, sizeof buffer);
    if (got <= 0) break;
    text.append(buffer, static_cast<size_t>(got));
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const size_t line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

void Emulator::refuse_ended() {
  int status = 0;
  if (child_ > 0 && ::waitpid(child_, &status, 0) == child_) child_ = -1;
  const std::string how = WIFEXITED(status) ? "exit status " + std::to_string(WEXITSTATUS(status))
                                            : "signal " + std::to_string(WTERMSIG(status));
  const std::string words = last_words();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && words.empty())
    refuse("chip", "was reset by its firmware, another start is accepted", "chip_reset");
  std::string hint = words.empty() ? "it ended by itself" : words;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {
    hint =
        std::string(kEmulatorProgram) + " cannot be run (" + hint + "), Debian's package qemu-system-arm is accepted";
  }
  refuse(how, hint, "emulator_ended");
}

bool Emulator::wait_readable_for(int fd, std::chrono::milliseconds patience) {
  const Clock::time_point end = Clock::now() + patience;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    if (left.count() < 0) return false;
    // In slices: an emulator that dies before it has opened a FIFO does not wake its reader.
    pollfd event{fd, POLLIN, 0};
    const int slice = static_cast<int>(std::min<long>(left.count() + 1, 200));
    if (::poll(&event, 1, slice) > 0) return true;
    siginfo_t ended{};
    if (::waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
        ended.si_pid == child_) {
      refuse_ended();
    }
  }
}

bool Emulator::ended() const {
  siginfo_t info{};
  const int done = ::waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOHANG | WNOWAIT);
  return done == 0 && info.si_pid == child_;
}

void Emulator::wait_readable(int fd, const std::string& waiting_for) {
  if (!wait_readable_for(fd, std::chrono::duration_cast<std::chrono::milliseconds>(kEmulatorPatience))) {
    refuse_silent(waiting_for);
  }
}

void Emulator::refuse_silent(const std::string& waiting_for) {
  refuse(waiting_for,
         "nothing came for " + std::to_string(kEmulatorPatience.count()) +
             " s, a stillpoint firmware image for the STM32F405 is accepted",
         "emulator_silent");
}

}  // namespace stillpoint::sim
