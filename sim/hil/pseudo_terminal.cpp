// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/pseudo_terminal.hpp"

#include <fcntl.h>
#include <termios.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

[[noreturn]] void refuse_terminal(const char* what) {
  throw Refusal(Refusal::Cause::kCannot, "serial port", what,
                std::string(std::strerror(errno)) + ", a system with pseudo-terminals is accepted", "no_serial_port");
}

}  // namespace

PseudoTerminal::PseudoTerminal() : ours_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  char name[128];
  if (ours_.get() < 0 || ::grantpt(ours_.get()) != 0 || ::unlockpt(ours_.get()) != 0) refuse_terminal("none");
  if (::ptsname_r(ours_.get(), name, sizeof name) != 0) refuse_terminal("without a name");
  path_ = name;
  theirs_ = FileDescriptor(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (theirs_.get() < 0 || ::tcgetattr(theirs_.get(), &settings) != 0) refuse_terminal(name);
  ::cfmakeraw(&settings);
  if (::tcsetattr(theirs_.get(), TCSANOW, &settings) != 0) refuse_terminal(name);
}

bool PseudoTerminal::read(uint8_t& byte) {
  if (next_ == end_) {
    const ssize_t got = ::read(ours_.get(), buffer_, sizeof buffer_);
    if (got <= 0) return false;
    next_ = 0;
    end_ = static_cast<size_t>(got);
  }
  byte = buffer_[next_++];
  return true;
}

bool PseudoTerminal::write(uint8_t byte) {
  unsent_.push_back(byte);
  return true;
}

void PseudoTerminal::flush() {
  if (unsent_.empty()) return;
  const ssize_t sent = ::write(ours_.get(), unsent_.data(), unsent_.size());
  if (sent > 0) unsent_.erase(unsent_.begin(), unsent_.begin() + sent);
}

}  // namespace stillpoint::sim
