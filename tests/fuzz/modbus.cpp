// SPDX-License-Identifier: Apache-2.0
// A whole drive under arbitrary bytes and ticks, for libFuzzer. The input is a programme: what the line carries, with
// or without a good CRC, and for how long time goes on. Of every tick: the output stage is on only in states that have
// it on, and the setpoint changes only where a set-point was taken since operation was enabled. (Crashes and undefined
// behaviour are the sanitizers' to find.)
//
// Written for one fuzzing process: the drive is made anew for every input, in the same static storage.
#include <stddef.h>
#include <stdint.h>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <new>

#include "firmware/application.hpp"
#include "firmware/crc16.hpp"
#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "tests/support/flash_model.hpp"

namespace {

using namespace stillpoint;
using firmware::DriveState;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "invariant broken: %s\n", what);
  std::abort();
}

struct Line final : hal::ByteStream {
  std::deque<uint8_t> to_drive;
  bool stuck = false;  // takes nothing
  size_t taken = 0;

  bool read(uint8_t& byte) override {
    if (to_drive.empty()) return false;
    byte = to_drive.front();
    to_drive.pop_front();
    return true;
  }
  bool write(uint8_t) override {
    if (stuck) return false;
    ++taken;
    return true;
  }
};

// Follows while enabled; loses feedbacks when told.
struct Servo final : hal::ServoPort {
  int64_t position = 0;
  uint16_t sequence = 0;
  bool valid = true;
  hal::ServoCommand last = {};
  hal::ServoCommand before = {};

  void disable() override { last.enabled = false; }
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    before = last;
    last = command;
    if (command.enabled) position = command.setpoint;
    return {position, 0, ++sequence, valid, true};
  }
};

struct Dog final : hal::Watchdog {
  void feed() override {}
};

void no_restart() {}

struct Rig {
  Axis<firmware::kLineCapacity> axis = {};
  firmware::Application drive = {};
  Servo servo;
  Line line;
  Dog dog;
  testing::FlashModel flash;
  bool taken = false;  // a set-point, since operation was enabled

  Rig() {
    if (!axis.configure(firmware::kDefaultAxis).ok()) fail("the axis takes its configuration");
    drive.begin(axis, {&servo, &line, &dog, &flash, no_restart});
  }

  void step(uint32_t ticks, bool linked) {
    for (uint32_t i = 0; i < ticks; ++i) {
      if (linked) {
        drive.tick();
        check();
      }
      drive.own_timer_tick();
      // A set-point may be taken and its bit gone within one poll of the other; both are looked at.
      for (int poll = 0; poll < 2; ++poll) {
        drive.poll();
        note();
      }
    }
  }

  void note() {
    const DriveState state = drive.drive().state();
    if (state == DriveState::kOperationEnabled && (drive.drive().statusword() & firmware::kStatusSetPointTaken) != 0) {
      taken = true;
    }
    if (!servo.last.enabled) taken = false;
  }

  void check() {
    if (servo.last.enabled) {
      const DriveState state = drive.drive().state();
      const bool may = state == DriveState::kSwitchedOn || state == DriveState::kOperationEnabled ||
                       state == DriveState::kQuickStopActive || state == DriveState::kFaultReaction ||
                       servo.before.enabled;  // on its way off: the background has not told the tick yet
      if (!may) fail("the output stage is on only in states that have it on");
    }
    const bool both = servo.last.enabled && servo.before.enabled;
    if (both && servo.last.setpoint != servo.before.setpoint && !taken) {
      fail("the setpoint changes only after a set-point was taken");
    }
  }
};

// The programme's bytes, zeros beyond its end.
class Reader {
 public:
  Reader(const uint8_t* data, size_t size) : at_(data), end_(data + size) {}
  bool done() const { return at_ == end_; }
  uint8_t next() { return at_ == end_ ? uint8_t{0} : *at_++; }

 private:
  const uint8_t* at_;
  const uint8_t* end_;
};

class Sender {
 public:
  explicit Sender(Rig& rig) : rig_(rig) {}

  void put(uint8_t byte) {
    rig_.line.to_drive.push_back(byte);
    crc_ = firmware::crc16_update(crc_, byte);
  }
  void end() {
    const uint16_t crc = crc_;
    rig_.line.to_drive.push_back(static_cast<uint8_t>(crc));
    rig_.line.to_drive.push_back(static_cast<uint8_t>(crc >> 8));
    rig_.step(5, true);
  }

 private:
  Rig& rig_;
  uint16_t crc_ = firmware::kCrc16Initial;
};

void write_register(Rig& rig, uint8_t unit, uint16_t address, uint16_t word) {
  Sender sender(rig);
  for (const int byte : {int{unit}, 6, address >> 8, address & 0xFF, word >> 8, word & 0xFF}) {
    sender.put(static_cast<uint8_t>(byte));
  }
  sender.end();
}

void send_frame(Rig& rig, Reader& input, uint8_t unit, size_t length) {
  Sender sender(rig);
  sender.put(unit);
  for (size_t i = 0; i < length; ++i) sender.put(input.next());
  sender.end();
}

// The parts of the map that have registers, so that the fuzzer need not find them bit by bit.
void write_mapped(Rig& rig, Reader& input) {
  constexpr uint16_t kBlocks[] = {0x0000, 0x0040, 0x0058, 0x0100, 0x0120, 0x0130, 0x0010, 0x0070};
  const uint8_t where = input.next();
  const auto address = static_cast<uint16_t>(kBlocks[where >> 5] + (where & 0x1F));
  const uint8_t high = input.next();
  write_register(rig, (high & 0x80) != 0 ? 0 : 1, address, static_cast<uint16_t>((high & 0x7F) << 8 | input.next()));
}

void run_one(Rig& rig, Reader& input) {
  const uint8_t operation = input.next();
  const uint8_t argument = operation >> 4;
  switch (operation & 0x0F) {
    case 0: rig.step(1U + argument, true); break;
    case 1: rig.step(20U * argument, true); break;
    case 2: rig.step(16U * argument, false); break;  // the servo link is silent
    case 3:
      for (int i = 0; i <= argument; ++i) rig.line.to_drive.push_back(input.next());
      break;
    case 4: send_frame(rig, input, 1, 1U + argument); break;
    case 5: send_frame(rig, input, 0, 1U + argument); break;
    case 6: send_frame(rig, input, 1, 16U * (1U + argument)); break;
    case 7: write_mapped(rig, input); break;
    case 8:
      for (const uint16_t word : {uint16_t{0x06}, uint16_t{0x07}, uint16_t{0x0F}}) write_register(rig, 1, 0x0040, word);
      break;
    case 9: write_register(rig, 1, 0x0040, static_cast<uint16_t>(argument << 4 | 0x0F)); break;
    case 10: write_register(rig, 1, 0x0040, static_cast<uint16_t>(input.next() << 8 | input.next())); break;
    case 11: write_register(rig, 0, 0x0040, static_cast<uint16_t>(input.next() << 8 | input.next())); break;
    case 12: {
      constexpr uint16_t kKeys[] = {0x554E, 0x5341, 0x4C44, 0x5253};
      write_register(rig, 1, 0x0014, kKeys[argument % 4]);
      break;
    }
    case 13: rig.servo.valid = argument != 0; break;
    case 14: rig.line.stuck = argument % 2 != 0; break;
    default: rig.flash.dead = argument % 2 != 0; break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr size_t kMostOperations = 64;
  alignas(Rig) static uint8_t storage[sizeof(Rig)];
  Rig* rig = new (storage) Rig();
  rig->step(3, true);
  Reader input(data, size);
  for (size_t i = 0; i < kMostOperations && !input.done(); ++i) run_one(*rig, input);
  rig->step(50, true);
  rig->~Rig();
  return 0;
}
