// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace stillpoint::cli {

Progress::Progress(const std::string& what)
    : what_(what), terminal_(isatty(STDERR_FILENO) != 0), due_(Clock::now() + std::chrono::seconds(1)) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(double part_done) {
  if (!terminal_ || Clock::now() < due_) return;
  due_ = Clock::now() + std::chrono::milliseconds(100);
  shown_ = true;
  std::fprintf(stderr, "\r\x1b[K%s: %.0f %%", what_.c_str(), 100.0 * part_done);
  std::fflush(stderr);
}

}  // namespace stillpoint::cli
