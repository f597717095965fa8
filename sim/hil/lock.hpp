// SPDX-License-Identifier: Apache-2.0
// The emulated chip, locked to the simulation tick by tick: no tick of one without the other's.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/byte_stream.hpp"
#include "hal/servo_port.hpp"

namespace stillpoint::sim {

// What the test image says of its ticks. The production image says nothing.
struct TickCost {
  uint32_t instructions;  // of Application::tick in this tick
  uint32_t late_ticks;    // so far: ticks not finished when the next was due
};

class Lock {
 public:
  virtual ~Lock() = default;

  // One tick: the sync goes out, the answer to it comes back. Throws a Refusal (`emulator_ended`,
  // `emulator_silent`, `chip_reset`).
  virtual hal::ServoCommand exchange(const hal::ServoFeedback& sync) = 0;

  // The other end of the firmware's client line. Bytes move while ticks do.
  virtual hal::ByteStream& client() = 0;

  // Of the newest tick.
  virtual std::optional<TickCost> cost() const = 0;
};

// What the test image's ticks follow. The production image's follow the servo link.
enum class Pace {
  kLock,        // each tick waits for the simulation; instructions are counted
  kFreeSysTick  // the chip's free-running millisecond; a tick that does not end in time is counted as late
};

// Starts the image: the production one through its serial lines, the test image (tests/hil/campaign), known by a
// marker in it, through semihosting. `pace` is for the test image, further `arguments` of the emulator's for the other.
std::unique_ptr<Lock> start_locked(const std::string& elf, Pace pace = Pace::kLock,
                                   const std::vector<std::string>& arguments = {});

}  // namespace stillpoint::sim
