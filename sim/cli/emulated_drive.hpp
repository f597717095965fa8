// SPDX-License-Identifier: Apache-2.0
// The firmware with the simulated arm and a client's line, on this host or on the emulated chip.
#pragma once

#include <memory>
#include <string>

#include "hal/byte_stream.hpp"
#include "sim/cli/page_file.hpp"
#include "sim/simulated_drive.hpp"

namespace stillpoint::cli {

class EmulatedDrive {
 public:
  virtual ~EmulatedDrive() = default;
  // A millisecond, the client's bytes with it. A reset that the client asks for is another start, on the parameters of
  // then; throws a Refusal where the emulator gives up.
  virtual void step() = 0;
};

// `memory` (may be null) takes what is saved. The history of faults outlasts a reset.
std::unique_ptr<EmulatedDrive> firmware_on_host(sim::SimulatedDrive& arm, hal::ByteStream& client, PageFile* memory);

// Every start is on what is in `memory` (may be null) then. The emulated chip cannot save: it has no flash controller;
// and it has no memory that outlasts a reset.
std::unique_ptr<EmulatedDrive> firmware_on_chip(const std::string& elf, sim::SimulatedDrive& arm,
                                                hal::ByteStream& client, const PageFile* memory);

}  // namespace stillpoint::cli
