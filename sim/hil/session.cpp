// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/session.hpp"

#include <cstdio>
#include <string>
#include <utility>

#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

std::string register_name(uint16_t address) {
  char text[16];
  std::snprintf(text, sizeof text, "%04Xh", address);
  return text;
}

}  // namespace

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

uint32_t Session::read32(uint16_t address) {
  const std::vector<uint16_t> words = read(address, 2);
  return static_cast<uint32_t>(words[0]) << 16 | words[1];
}

void Session::write(uint16_t address, uint16_t value) {
  client_.write(address, value);
  ask(address);
}

void Session::write32(uint16_t address, uint32_t value) {
  write(address, std::vector<uint16_t>{static_cast<uint16_t>(value >> 16), static_cast<uint16_t>(value)});
}

void Session::write(uint16_t address, const std::vector<uint16_t>& values) {
  client_.write(address, values);
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
      throw Refusal(Refusal::Cause::kCannot, "register", register_name(address),
                    "the firmware refused with Modbus exception " + std::to_string(answer->exception) +
                        ", registers 0012h and 0013h name what would be accepted",
                    "client_refused");
    }
    client_.repeat();
    ++repeated_;
  }
  client_.give_up();
  throw Refusal(Refusal::Cause::kCannot, "register", register_name(address),
                "no answer to " + std::to_string(kAttempts) + " requests, a firmware that answers is accepted",
                "client_silent");
}

}  // namespace stillpoint::sim
