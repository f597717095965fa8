// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/modbus_port.hpp"

#include <fmt/format.h>
#include <modbus/modbus.h>

#include <cerrno>

#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

// The drive answers at once; while it plans or identifies, between two steps of that.
constexpr uint32_t kAnswerSeconds = 1;
constexpr int kAttempts = 5;

void close_port(modbus_t* modbus) {
  if (modbus == nullptr) return;
  modbus_close(modbus);
  modbus_free(modbus);
}

bool is_exception(int error) { return error > MODBUS_ENOBASE && error < MODBUS_ENOBASE + MODBUS_EXCEPTION_MAX; }

// Asks again where nothing, or nothing whole, came.
template <typename Ask>
bool asked(const Ask& ask) {
  for (int attempt = 1; attempt <= kAttempts; ++attempt) {
    if (ask() >= 0) return true;
    if (is_exception(errno)) return false;
  }
  return false;
}

}  // namespace

ModbusPort::ModbusPort(const SerialSettings& settings)
    : modbus_(modbus_new_rtu(settings.device.c_str(), settings.baud, settings.parity, 8, settings.stop_bits),
              close_port) {
  const bool open = modbus_ != nullptr && modbus_set_slave(modbus_.get(), settings.unit) == 0 &&
                    modbus_set_response_timeout(modbus_.get(), kAnswerSeconds, 0) == 0 &&
                    modbus_connect(modbus_.get()) == 0;
  if (!open) {
    throw sim::bad_argument("PORT", settings.device,
                            fmt::format("cannot be opened ({}), a serial port is accepted", modbus_strerror(errno)));
  }
  modbus_set_error_recovery(modbus_.get(), MODBUS_ERROR_RECOVERY_PROTOCOL);
}

uint64_t ModbusPort::ticks() const {
  const auto passed = std::chrono::steady_clock::now() - opened_;
  return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::milliseconds>(passed).count());
}

std::vector<uint16_t> ModbusPort::read(uint16_t address, uint16_t count) {
  std::vector<uint16_t> words(count);
  if (!asked([&] { return modbus_read_registers(modbus_.get(), address, count, words.data()); })) refuse(address);
  return words;
}

void ModbusPort::write(uint16_t address, const std::vector<uint16_t>& values) {
  const auto count = static_cast<int>(values.size());
  const bool done = asked([&] {
    return count == 1 ? modbus_write_register(modbus_.get(), address, values[0])
                      : modbus_write_registers(modbus_.get(), address, count, values.data());
  });
  if (!done) refuse(address);
}

void ModbusPort::refuse(uint16_t address) const {
  const int error = errno;
  if (is_exception(error)) throw sim::refused_register(address, error - MODBUS_ENOBASE);
  throw sim::silent_register(address, kAttempts, modbus_strerror(error));
}

}  // namespace stillpoint::cli
