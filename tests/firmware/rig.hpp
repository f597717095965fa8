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
#include "tests/support/test.hpp"

namespace stillpoint::testing {

using Bytes = std::vector<uint8_t>;

// Bit by bit, from the specification; not the product's.
inline uint16_t reference_crc(const Bytes& bytes) {
  uint32_t crc = 0xFFFF;
  for (const uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? (crc >> 1) ^ 0xA001 : crc >> 1;
  }
  return static_cast<uint16_t>(crc);
}

inline Bytes framed(Bytes body) {
  const uint16_t crc = reference_crc(body);
  body.push_back(static_cast<uint8_t>(crc & 0xFF));
  body.push_back(static_cast<uint8_t>(crc >> 8));
  return body;
}

inline void append_word(Bytes& bytes, uint32_t word) {
  bytes.push_back(static_cast<uint8_t>(word >> 8));
  bytes.push_back(static_cast<uint8_t>(word));
}

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

struct Rig {
  Axis<firmware::kLineCapacity> axis;
  firmware::Application drive;
  Servo servo;
  Line line;
  Dog dog;
  firmware::FaultMemory faults = {};

  TuneMemory tune_memory = {};

  Rig() : Rig(servo) {}
  explicit Rig(hal::ServoPort& port) {
    TEST_ASSERT_OK(axis.configure(firmware::kDefaultAxis));
    drive.begin(axis, {&port, &line, &dog, &faults, &tune_memory});
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

  // The response's PDU; empty when none comes within 20 ms. The frame around it is checked.
  Bytes exchange(const Bytes& pdu, uint8_t unit = 1) {
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

  static Bytes read_request(uint32_t first, uint32_t count, uint8_t function = 3) {
    Bytes pdu{function};
    append_word(pdu, first);
    append_word(pdu, count);
    return pdu;
  }

  static Bytes write_request(uint32_t first, const std::vector<uint16_t>& words) {
    Bytes pdu{16};
    append_word(pdu, first);
    append_word(pdu, static_cast<uint32_t>(words.size()));
    pdu.push_back(static_cast<uint8_t>(2 * words.size()));
    for (const uint16_t word : words) append_word(pdu, word);
    return pdu;
  }

  // 0 for a normal response, the exception code otherwise.
  static uint32_t exception_in(const Bytes& response) {
    TEST_ASSERT_AT_LEAST_INT64(2, response.size());
    return (response[0] & 0x80) != 0 ? response[1] : 0;
  }

  uint32_t write_single(uint32_t address, uint32_t word) {
    Bytes pdu{6};
    append_word(pdu, address);
    append_word(pdu, word);
    const Bytes response = exchange(pdu);
    if (exception_in(response) == 0) TEST_ASSERT_TRUE(response == pdu);
    return exception_in(response);
  }

  uint32_t write(uint32_t first, const std::vector<uint16_t>& words) {
    return exception_in(exchange(write_request(first, words)));
  }

  uint32_t write_wide(uint32_t address, int64_t value) {
    return write(address, {static_cast<uint16_t>(value >> 16), static_cast<uint16_t>(value)});
  }

  std::vector<uint16_t> read(uint32_t first, uint32_t count) {
    const Bytes response = exchange(read_request(first, count));
    TEST_ASSERT_EQUAL_UINT32(0, exception_in(response));
    TEST_ASSERT_EQUAL_UINT32(2 * count, response[1]);
    TEST_ASSERT_EQUAL_UINT32(2 + 2 * count, response.size());
    std::vector<uint16_t> words;
    for (size_t i = 2; i < response.size(); i += 2) {
      words.push_back(static_cast<uint16_t>((response[i] << 8) | response[i + 1]));
    }
    return words;
  }

  uint32_t get(uint32_t address) { return read(address, 1)[0]; }
  uint32_t get_wide(uint32_t address) {
    const std::vector<uint16_t> words = read(address, 2);
    return (uint32_t{words[0]} << 16) | words[1];
  }
  uint32_t status() { return get(0x0041); }

  void control(uint32_t word) { TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0040, word)); }

  void enable() {
    control(0x06);
    TEST_ASSERT_EQUAL_UINT32(0x0021, status() & 0x006F);
    control(0x07);
    TEST_ASSERT_EQUAL_UINT32(0x0023, status() & 0x006F);
    control(0x0F);
    TEST_ASSERT_EQUAL_UINT32(0x0027, status() & 0x006F);
  }

  void unlock() { TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0014, 0x554E)); }
};

}  // namespace stillpoint::testing
