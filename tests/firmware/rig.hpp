// SPDX-License-Identifier: Apache-2.0
// The whole drive on the host: a servo that follows its setpoint exactly, a serial line as two queues, a client that
// speaks Modbus RTU with its own CRC. Time goes on only in `step`.
#pragma once

#include <stdint.h>

#include <deque>
#include <functional>
#include <initializer_list>
#include <vector>

#include "firmware/application.hpp"
#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "tests/firmware/client.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

struct Line final : hal::ByteStream {
  std::deque<uint8_t> to_drive;
  Bytes from_drive;
  size_t room = SIZE_MAX;  // bytes that the line takes until it is given more
  std::function<void()> on_read;

  bool read(uint8_t& byte) override {
    if (on_read) on_read();
    if (to_drive.empty()) return false;
    byte = to_drive.front();
    to_drive.pop_front();
    return true;
  }
  bool write(uint8_t byte) override {
    if (room == 0) return false;
    --room;
    from_drive.push_back(byte);
    return true;
  }
};

// Stands where it was put while disabled, follows exactly while enabled, but for what is wrong with it.
struct Servo final : hal::ServoPort {
  int64_t position = 0;
  uint16_t sequence = 100;
  bool valid = true;
  bool commit = true;
  bool count_up = true;
  bool stuck = false;       // the motor
  int64_t encoder_off = 0;  // what the encoder reads too much
  std::vector<hal::ServoCommand> commands;

  void disable() override {
    if (!commands.empty()) commands.back().enabled = false;
  }
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    commands.push_back(command);
    if (command.enabled && !stuck) position = command.setpoint;
    if (count_up) ++sequence;
    return {position + encoder_off, 0, sequence, valid, commit};
  }
  bool enabled() const { return !commands.empty() && commands.back().enabled; }
  int64_t setpoint() const { return commands.back().setpoint; }
};

struct Dog final : hal::Watchdog {
  uint32_t meals = 0;
  void feed() override { ++meals; }
};

struct Rig : Client {
  Axis<firmware::kLineCapacity> axis;
  firmware::Application drive;
  Servo servo;
  Line line;
  Dog dog;
  firmware::FaultMemory faults = {};

  TuneMemory tune_memory = {};

  Rig() { connect(servo); }
  explicit Rig(hal::ServoPort& port, hal::Nonvolatile* memory = nullptr) { connect(port, memory); }
  void connect(hal::ServoPort& port, hal::Nonvolatile* memory = nullptr) {
    TEST_ASSERT_OK(axis.configure(firmware::kDefaultAxis));
    drive.begin(axis, {&port, &line, &dog, &faults, &tune_memory, memory});
    step(2);
  }

  // Milliseconds with the servo link up.
  void step(uint32_t ticks = 1) {
    for (uint32_t i = 0; i < ticks; ++i) {
      drive.tick();
      drive.own_timer_tick();
      drive.poll();
      drive.poll();
    }
  }

  // Milliseconds without it.
  void step_silent(uint32_t ms) {
    for (uint32_t i = 0; i < ms; ++i) {
      drive.own_timer_tick();
      drive.poll();
      drive.poll();
    }
  }

  void send(const Bytes& frame) { line.to_drive.insert(line.to_drive.end(), frame.begin(), frame.end()); }

  Bytes exchange_with(uint8_t unit, const Bytes& pdu) override {
    Bytes body{unit};
    body.insert(body.end(), pdu.begin(), pdu.end());
    line.from_drive.clear();
    send(framed(body));
    step(20);
    return answer(unit);
  }

  Bytes answer(uint8_t unit = 1) {
    Bytes got = line.from_drive;
    line.from_drive.clear();
    if (got.empty()) return got;
    TEST_ASSERT_AT_LEAST_INT64(4, got.size());
    TEST_ASSERT_EQUAL_UINT32(unit, got[0]);
    TEST_ASSERT_EQUAL_UINT32(0, reference_crc(got));
    return Bytes(got.begin() + 1, got.end() - 2);
  }
};

}  // namespace stillpoint::testing
