// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/refusal.hpp"

namespace stillpoint::sim {

// The registers of a drive, however they are reached. All of it throws a Refusal: `client_silent` where no answer
// comes, `client_refused` for an exception.
class RegisterPort {
 public:
  virtual ~RegisterPort() = default;

  // 1 to 125 registers.
  virtual std::vector<uint16_t> read(uint16_t address, uint16_t count) = 0;
  // 1 to 123 registers; one by itself goes out as a single write.
  virtual void write(uint16_t address, const std::vector<uint16_t>& values) = 0;
  // The drive's milliseconds, near enough to give up by.
  virtual uint64_t ticks() const = 0;

  uint32_t read32(uint16_t address) {
    const std::vector<uint16_t> words = read(address, 2);
    return static_cast<uint32_t>(words[0]) << 16 | words[1];
  }
  void write(uint16_t address, uint16_t value) { write(address, std::vector<uint16_t>{value}); }
  void write32(uint16_t address, uint32_t value) {
    write(address, std::vector<uint16_t>{static_cast<uint16_t>(value >> 16), static_cast<uint16_t>(value)});
  }
};

// The drive has answered with a Modbus exception.
class RegisterRefusal : public Refusal {
 public:
  RegisterRefusal(uint16_t address, int exception);
  uint16_t address() const { return address_; }  // the first of the request
  int exception() const { return exception_; }

 private:
  uint16_t address_;
  int exception_;
};
inline RegisterRefusal refused_register(uint16_t address, int exception) { return {address, exception}; }
// The last of so many requests went unanswered too. `why`: what the line says of it, or nothing.
Refusal silent_register(uint16_t address, uint32_t requests, const std::string& why = {});

}  // namespace stillpoint::sim
