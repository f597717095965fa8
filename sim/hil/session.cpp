// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/session.hpp"

#include <utility>

namespace stillpoint::sim {

Session::Session(Lock& lock, hal::ServoPort& drive, OnTick on_tick, uint8_t unit)
    : lock_(lock), drive_(drive), on_tick_(std::move(on_tick)), client_(lock.client(), unit) {}

void Session::tick() {
  command_ = lock_.exchange(drive_.exchange(command_));
  ++ticks_;
  if (on_tick_) on_tick_(command_);
}

std::vector<uint16_t> Session::read(uint16_t address, uint16_t count) {
  client_.read(address, count);
  return ask(address).registers;
}

void Session::write(uint16_t address, const std::vector<uint16_t>& values) {
  if (values.size() == 1) {
    client_.write(address, values[0]);
  } else {
    client_.write(address, values);
  }
  ask(address);
}

std::optional<ModbusAnswer> Session::wait_for_answer() {
  for (uint32_t waited = 0; waited < kAnswerTicks; ++waited) {
    if (auto answer = client_.poll()) return answer;
    tick();
  }
  return std::nullopt;
}

ModbusAnswer Session::ask(uint16_t address) {
  for (uint32_t attempt = 1; attempt <= kAttempts; ++attempt) {
    if (const auto answer = wait_for_answer()) {
      if (answer->exception == 0) return *answer;
      throw refused_register(address, answer->exception);
    }
    client_.repeat();
    ++repeated_;
  }
  client_.give_up();
  throw silent_register(address, kAttempts);
}

}  // namespace stillpoint::sim
