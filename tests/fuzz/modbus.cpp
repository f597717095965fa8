// SPDX-License-Identifier: Apache-2.0
// A whole drive under arbitrary bytes and ticks, for libFuzzer. The input is a programme: what the line carries, with
// or without a good CRC, and for how long time goes on. Of every tick: the output stage is on only in states that have
// it on, and is switched on only by a request to this drive alone; the setpoint changes only where such a request has
// asked for motion since then (witness.hpp), and by no more than the axis's maximum velocity. (Crashes and undefined
// behaviour are the sanitizers' to find.)
//
// Written for one fuzzing process: the drive is made anew for every input, in the same static storage.
#include <stddef.h>
#include <stdint.h>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <new>
#include <vector>

#include "firmware/application.hpp"
#include "firmware/crc16.hpp"
#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "tests/fuzz/witness.hpp"
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
  testing::Witness witness;
  bool stuck = false;  // takes nothing
  size_t taken = 0;

  void send(uint8_t byte) {
    to_drive.push_back(byte);
    witness.sent(byte);
  }
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
  TuneMemory tune_memory = {};
  firmware::FaultMemory faults = {};
  uint32_t standing_ticks = 0;

  Rig() {
    if (!axis.configure(firmware::kDefaultAxis).ok()) fail("the axis takes its configuration");
    drive.begin(axis, {&servo, &line, &dog, &faults, &tune_memory, &flash, no_restart});
  }

  void step(uint32_t ticks, bool linked) {
    for (uint32_t i = 0; i < ticks; ++i) {
      if (linked) {
        drive.tick();
        check();
      }
      drive.own_timer_tick();
      drive.poll();
      drive.poll();
    }
  }

  void check() {
    const int64_t change = wrapping_difference(servo.last.setpoint, servo.before.setpoint);
    standing_ticks = change == 0 ? standing_ticks + 1 : 0;
    line.witness.tick(servo.last.enabled, line.to_drive.empty() && !line.stuck, standing_ticks);
    if (servo.last.enabled && !servo.before.enabled && !line.witness.may_switch_on()) {
      fail("the output stage is switched on only by a request to this drive");
    }
    if (servo.last.enabled) {
      const DriveState state = drive.drive().state();
      const bool may = state == DriveState::kSwitchedOn || state == DriveState::kOperationEnabled ||
                       state == DriveState::kQuickStopActive || state == DriveState::kFaultReaction ||
                       servo.before.enabled;  // on its way off: the background has not told the tick yet
      if (!may) fail("the output stage is on only in states that have it on");
    }
    const bool both = servo.last.enabled && servo.before.enabled;
    if (both && change != 0 && !line.witness.may_move()) fail("the setpoint changes only where motion was asked for");
    // A shaper with negative impulses takes it further, to 3 by UM-ZV.
    const double most = 3.0 * axis.config().maximum.velocity * axis.config().tick_s + 1.0;
    const double counts = static_cast<double>(change) / static_cast<double>(kSignalPerCount);
    if (both && (counts > most || counts < -most)) fail("the setpoint keeps the maximum velocity");
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
    rig_.line.send(byte);
    crc_ = firmware::crc16_update(crc_, byte);
  }
  void end() {
    const uint16_t crc = crc_;
    rig_.line.send(static_cast<uint8_t>(crc));
    rig_.line.send(static_cast<uint8_t>(crc >> 8));
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
  constexpr uint16_t kBlocks[] = {0x0010, 0x0040, 0x0058, 0x0070, 0x0100, 0x0130, 0x0200, 0x0240};
  const uint8_t where = input.next();
  const auto address = static_cast<uint16_t>(kBlocks[where >> 5] + (where & 0x1F));
  const uint8_t high = input.next();
  write_register(rig, (high & 0x80) != 0 ? 0 : 1, address, static_cast<uint16_t>((high & 0x7F) << 8 | input.next()));
}

void write_registers(Rig& rig, uint16_t first, const std::vector<uint16_t>& words) {
  Sender sender(rig);
  const auto count = static_cast<uint8_t>(words.size());
  for (const int byte : {1, 16, first >> 8, first & 0xFF, 0, int{count}, 2 * count}) {
    sender.put(static_cast<uint8_t>(byte));
  }
  for (const uint16_t word : words) {
    sender.put(static_cast<uint8_t>(word >> 8));
    sender.put(static_cast<uint8_t>(word));
  }
  sender.end();
}

void write_wide(Rig& rig, uint16_t address, int32_t value) {
  const auto bits = static_cast<uint32_t>(value);
  write_registers(rig, address, {static_cast<uint16_t>(bits >> 16), static_cast<uint16_t>(bits)});
}

// Positions about where it stands, as a stream wants them.
void write_stream(Rig& rig, Reader& input) {
  int32_t at = counts_from_signal(rig.servo.last.setpoint);
  std::vector<uint16_t> words;
  for (int i = 0; i < 8; ++i) {
    const auto bits = static_cast<uint32_t>(at);
    words.push_back(static_cast<uint16_t>(bits >> 16));
    words.push_back(static_cast<uint16_t>(bits));
    at += static_cast<int8_t>(input.next());
  }
  write_registers(rig, 0x0090, words);
}

// What it takes several requests to get to.
void run_known(Rig& rig, Reader& input, uint8_t which) {
  switch (which) {
    case 0:
    case 1:
    case 2:
    case 3: {
      constexpr uint16_t kModes[] = {1, 3, 6, 8};
      return write_register(rig, 1, 0x0042, kModes[which]);
    }
    case 4: return write_wide(rig, 0x0052, static_cast<int8_t>(input.next()) * 10000);
    case 5: return write_stream(rig, input);
    case 6: return write_register(rig, 1, 0x0200, 1);
    case 7: return write_register(rig, 1, 0x0200, static_cast<uint16_t>(2 + input.next() % 3));
    case 8: return write_register(rig, 1, 0x0300, input.next() % 3);
    case 9: return rig.step(1500, true);
    case 10: return write_wide(rig, 0x0044, static_cast<int8_t>(input.next()) * 5000);
    case 11: return write_register(rig, 1, 0x0040, static_cast<uint16_t>(0x1F | (input.next() & 0x60)));
    case 12: return write_register(rig, 1, 0x0040, 0x0F);
    case 13: return write_register(rig, 1, 0x0079, input.next() % 3);
    case 14: return write_register(rig, 1, 0x0250, input.next() % 3);
    default: return write_register(rig, 0, 0x0200, 1 + input.next() % 4U);
  }
}

void run_one(Rig& rig, Reader& input) {
  const uint8_t operation = input.next();
  const uint8_t argument = operation >> 4;
  switch (operation & 0x0F) {
    case 0: rig.step(1U + argument, true); break;
    case 1: rig.step(20U * argument, true); break;
    case 2: rig.step(16U * argument, false); break;  // the servo link is silent
    case 3:
      for (int i = 0; i <= argument; ++i) rig.line.send(input.next());
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
    case 14:
      rig.line.stuck = (argument & 1) != 0;
      rig.flash.dead = (argument & 2) != 0;
      break;
    default: run_known(rig, input, argument); break;
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
