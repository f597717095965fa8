// SPDX-License-Identifier: Apache-2.0
// A drive at the other end of a serial port: Modbus RTU by libmodbus.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "sim/hil/register_port.hpp"

struct _modbus;  // libmodbus's modbus_t

namespace stillpoint::cli {

struct SerialSettings {
  std::string device;
  int baud = 115200;
  char parity = 'E';  // N, E, O
  int stop_bits = 1;
  int unit = 1;
};

class ModbusPort final : public sim::RegisterPort {
 public:
  // Throws a Refusal where the device cannot be opened.
  explicit ModbusPort(const SerialSettings& settings);

  std::vector<uint16_t> read(uint16_t address, uint16_t count) override;
  using RegisterPort::write;
  void write(uint16_t address, const std::vector<uint16_t>& values) override;
  uint64_t ticks() const override;

 private:
  void refuse(uint16_t address) const;

  std::unique_ptr<_modbus, void (*)(_modbus*)> modbus_;
  std::chrono::steady_clock::time_point opened_ = std::chrono::steady_clock::now();
};

}  // namespace stillpoint::cli
