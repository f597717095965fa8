// SPDX-License-Identifier: Apache-2.0
// A minimal Modbus RTU master: functions 3, 6 and 16, one request at a time, never waiting. The answer needs ticks on
// the servo link to come (the firmware counts silence in them), so whoever asks ticks on and polls after each tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/byte_stream.hpp"

namespace stillpoint::sim {

struct ModbusAnswer {
  uint8_t exception = 0;            // 0: done
  std::vector<uint16_t> registers;  // of a read
};

class ModbusClient {
 public:
  ModbusClient(hal::ByteStream& line, uint8_t unit) : line_(line), unit_(unit) {}

  // Each begins a request; the one before must have been answered or given up. 1 to 125 registers.
  void read(uint16_t address, uint16_t count);
  void write(uint16_t address, uint16_t value);
  // 1 to 123 registers.
  void write(uint16_t address, const std::vector<uint16_t>& values);

  // Sends what is left of the request and takes what came. The answer, once it is whole; then the client is free.
  // Throws a Refusal (`client_protocol`) for a whole answer that is not one to this request.
  std::optional<ModbusAnswer> poll();

  bool busy() const { return !request_.empty(); }

  // Sends the request under way once more; what has come of an answer is dropped.
  void repeat();

  // Forgets the request and everything received.
  void give_up();

 private:
  void begin(std::vector<uint8_t> request);
  void drop_received();
  size_t answer_length() const;
  ModbusAnswer decode() const;

  hal::ByteStream& line_;
  uint8_t unit_;
  std::vector<uint8_t> request_;
  size_t sent_ = 0;
  std::vector<uint8_t> received_;
};

}  // namespace stillpoint::sim
