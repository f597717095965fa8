// SPDX-License-Identifier: Apache-2.0
// A Modbus client's requests, however they reach the drive. Independent of the product's own framing and CRC.
#pragma once

#include <stdint.h>

#include <initializer_list>
#include <vector>

#include "tests/support/reference_crc.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

using Bytes = std::vector<uint8_t>;

inline uint16_t reference_crc(const Bytes& bytes) { return reference_crc(bytes.data(), bytes.size()); }

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

struct Client {
  virtual ~Client() = default;

  // The response's PDU; empty when none comes. The frame around it is checked.
  virtual Bytes exchange_with(uint8_t unit, const Bytes& pdu) = 0;
  Bytes exchange(const Bytes& pdu, uint8_t unit = 1) { return exchange_with(unit, pdu); }

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

  void expect_refused(uint32_t reason, uint32_t culprit) {
    TEST_ASSERT_EQUAL_UINT32(reason, get(0x0012));
    TEST_ASSERT_EQUAL_UINT32(culprit, get(0x0013));
  }

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

  uint32_t state() { return status() & 0x006F; }
  // 1e6 counts take 1.05 s or so.
  void start_move(int32_t target, uint32_t word = 0x1F) {
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, target));
    control(word);
  }
  int64_t demand() { return static_cast<int32_t>(get_wide(0x004A)); }
};

}  // namespace stillpoint::testing
