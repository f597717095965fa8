// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/modbus_client.hpp"

#include <cstdio>
#include <stdexcept>
#include <string>

#include "firmware/crc16.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

constexpr uint8_t kReadHolding = 3;
constexpr uint8_t kWriteSingle = 6;
constexpr uint8_t kWriteMultiple = 16;
constexpr uint8_t kExceptionBit = 0x80;
constexpr size_t kExceptionLength = 5;
constexpr size_t kWriteAnswerLength = 8;

void put(std::vector<uint8_t>& bytes, uint16_t value) {
  bytes.push_back(static_cast<uint8_t>(value >> 8));
  bytes.push_back(static_cast<uint8_t>(value));
}

std::string hexadecimal(const std::vector<uint8_t>& bytes) {
  std::string text;
  for (const uint8_t byte : bytes) {
    char digits[4];
    std::snprintf(digits, sizeof digits, text.empty() ? "%02X" : " %02X", byte);
    text += digits;
  }
  return text;
}

}  // namespace

void ModbusClient::read(uint16_t address, uint16_t count) {
  std::vector<uint8_t> request = {unit_, kReadHolding};
  put(request, address);
  put(request, count);
  begin(std::move(request));
}

void ModbusClient::write(uint16_t address, uint16_t value) {
  std::vector<uint8_t> request = {unit_, kWriteSingle};
  put(request, address);
  put(request, value);
  begin(std::move(request));
}

void ModbusClient::write(uint16_t address, const std::vector<uint16_t>& values) {
  std::vector<uint8_t> request = {unit_, kWriteMultiple};
  put(request, address);
  put(request, static_cast<uint16_t>(values.size()));
  request.push_back(static_cast<uint8_t>(2 * values.size()));
  for (const uint16_t value : values) put(request, value);
  begin(std::move(request));
}

void ModbusClient::begin(std::vector<uint8_t> request) {
  if (busy()) throw std::logic_error("ModbusClient: a request is under way");
  const uint16_t crc = firmware::crc16(request.data(), request.size());
  request.push_back(static_cast<uint8_t>(crc));
  request.push_back(static_cast<uint8_t>(crc >> 8));
  request_ = std::move(request);
  sent_ = 0;
  received_.clear();
}

std::optional<ModbusAnswer> ModbusClient::poll() {
  if (!busy()) return std::nullopt;
  while (sent_ < request_.size() && line_.write(request_[sent_])) ++sent_;
  uint8_t byte = 0;
  while (received_.size() < answer_length() && line_.read(byte)) received_.push_back(byte);
  if (received_.size() < answer_length()) return std::nullopt;
  ModbusAnswer answer = decode();
  request_.clear();
  return answer;
}

void ModbusClient::repeat() {
  drop_received();
  sent_ = 0;
}

void ModbusClient::give_up() {
  drop_received();
  request_.clear();
}

void ModbusClient::drop_received() {
  received_.clear();
  uint8_t byte = 0;
  while (line_.read(byte)) {
  }
}

// As far as it is known yet.
size_t ModbusClient::answer_length() const {
  if (received_.size() >= 2 && (received_[1] & kExceptionBit) != 0) return kExceptionLength;
  if (request_[1] != kReadHolding) return kWriteAnswerLength;
  return received_.size() < 3 ? kExceptionLength : 5u + received_[2];
}

ModbusAnswer ModbusClient::decode() const {
  const size_t length = received_.size();
  const unsigned sent_crc = received_[length - 2] | static_cast<unsigned>(received_[length - 1]) << 8;
  const bool exception = (received_[1] & kExceptionBit) != 0;
  const bool fits = received_[0] == unit_ && (received_[1] & ~kExceptionBit) == request_[1] &&
                    sent_crc == firmware::crc16(received_.data(), length - 2);
  const size_t registers = request_[1] == kReadHolding && !exception ? (length - 5) / 2 : 0;
  const bool as_many = registers == 0 || registers == (static_cast<size_t>(request_[4]) << 8 | request_[5]);
  if (!fits || !as_many) {
    throw Refusal(Refusal::Cause::kCannot, "modbus answer", hexadecimal(received_),
                  "does not answer " + hexadecimal(request_) + ", an answer to it is accepted", "client_protocol");
  }
  ModbusAnswer answer;
  if (exception) answer.exception = received_[2];
  for (size_t i = 0; i < registers; ++i) {
    answer.registers.push_back(static_cast<uint16_t>(received_[3 + 2 * i] << 8 | received_[4 + 2 * i]));
  }
  return answer;
}

}  // namespace stillpoint::sim
