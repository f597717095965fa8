// SPDX-License-Identifier: Apache-2.0
// A simulated drive, the emulated firmware that commands it, and a client of that firmware, in step.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "hal/servo_port.hpp"
#include "sim/hil/lock.hpp"
#include "sim/hil/modbus_client.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::sim {

class Session final : public RegisterPort {
 public:
  // Ticks that a client waits for its answer before it asks again, and how often it asks. The firmware may plan in
  // between (see AxisCore::command); and on a loaded host its own millisecond can run ahead of the bytes that the
  // emulator hands over one by one, so that it sees silence inside a request and drops it, as on a bad line.
  static constexpr uint32_t kAnswerTicks = 1000;
  static constexpr uint32_t kAttempts = 60;

  // `drive` is given the firmware's commands, one a tick. `on_tick`, if any, sees each as it comes.
  using OnTick = std::function<void(const hal::ServoCommand&)>;
  Session(Lock& lock, hal::ServoPort& drive, OnTick on_tick = {}, uint8_t unit = 1);

  void tick();

  // These tick until the firmware has answered.
  std::vector<uint16_t> read(uint16_t address, uint16_t count) override;
  using RegisterPort::write;
  void write(uint16_t address, const std::vector<uint16_t>& values) override;

  // Requests sent again; 0 on a machine that keeps up.
  uint32_t repeated_requests() const { return repeated_; }
  uint64_t ticks() const override { return ticks_; }
  const hal::ServoCommand& command() const { return command_; }

 private:
  ModbusAnswer ask(uint16_t address);
  std::optional<ModbusAnswer> wait_for_answer();

  Lock& lock_;
  hal::ServoPort& drive_;
  OnTick on_tick_;
  ModbusClient client_;
  hal::ServoCommand command_ = {};
  uint64_t ticks_ = 0;
  uint32_t repeated_ = 0;
};

}  // namespace stillpoint::sim
