// SPDX-License-Identifier: Apache-2.0
// A serial port that another program can open.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/byte_stream.hpp"
#include "sim/hil/file_descriptor.hpp"

namespace stillpoint::sim {

// Never waits. Parity and speed mean nothing to it; a client must ask for no parity. Linux only.
class PseudoTerminal final : public hal::ByteStream {
 public:
  // Throws a Refusal when the system has none to give.
  PseudoTerminal();

  // What the other program opens.
  const std::string& path() const { return path_; }

  bool read(uint8_t& byte) override;
  bool write(uint8_t byte) override;
  // What was written goes out.
  void flush();

 private:
  FileDescriptor ours_;
  FileDescriptor theirs_;  // kept open, so that a client may come and go
  std::string path_;
  std::vector<uint8_t> unsent_;
  uint8_t buffer_[256] = {};
  size_t next_ = 0;
  size_t end_ = 0;
};

}  // namespace stillpoint::sim
