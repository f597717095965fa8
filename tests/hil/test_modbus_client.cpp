// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/modbus_client.hpp"

#include <deque>
#include <string>

#include "sim/refusal.hpp"
#include "tests/firmware/rig.hpp"
#include "tests/support/test.hpp"

namespace {

using namespace stillpoint;
using stillpoint::testing::Bytes;
using stillpoint::testing::framed;

// The client's end of a line.
struct Wire final : hal::ByteStream {
  Bytes sent;
  std::deque<uint8_t> coming;
  size_t room = SIZE_MAX;

  bool read(uint8_t& byte) override {
    if (coming.empty()) return false;
    byte = coming.front();
    coming.pop_front();
    return true;
  }
  bool write(uint8_t byte) override {
    if (room == 0) return false;
    --room;
    sent.push_back(byte);
    return true;
  }
  void answer(const Bytes& body) {
    for (const uint8_t byte : framed(body)) coming.push_back(byte);
  }
};

struct Asking {
  Wire wire;
  sim::ModbusClient client{wire, 1};
};

void check_bytes(const Bytes& expected, const Bytes& actual) {
  TEST_ASSERT_EQUAL_UINT32(expected.size(), actual.size());
  for (size_t i = 0; i < expected.size(); ++i) TEST_ASSERT_EQUAL_UINT32(expected[i], actual[i]);
}

bool refuses(sim::ModbusClient& client) {
  try {
    client.poll();
  } catch (const sim::Refusal& refusal) {
    return refusal.result() == "client_protocol";
  }
  return false;
}

}  // namespace

TEST_F(Asking, a_read_gives_the_registers) {
  client.read(0x0041, 2);
  TEST_ASSERT_FALSE(client.poll().has_value());
  check_bytes(framed({1, 3, 0x00, 0x41, 0x00, 0x02}), wire.sent);
  wire.answer({1, 3, 4, 0x12, 0x34, 0x56, 0x78});
  const auto answer = client.poll();
  TEST_ASSERT_TRUE(answer.has_value());
  TEST_ASSERT_EQUAL_UINT32(0, answer->exception);
  TEST_ASSERT_EQUAL_UINT32(2, answer->registers.size());
  TEST_ASSERT_EQUAL_UINT32(0x1234, answer->registers[0]);
  TEST_ASSERT_EQUAL_UINT32(0x5678, answer->registers[1]);
  TEST_ASSERT_FALSE(client.busy());
}

TEST_F(Asking, writes_are_functions_6_and_16) {
  client.write(0x0040, uint16_t{0x000F});
  client.poll();
  check_bytes(framed({1, 6, 0x00, 0x40, 0x00, 0x0F}), wire.sent);
  wire.answer({1, 6, 0x00, 0x40, 0x00, 0x0F});
  TEST_ASSERT_TRUE(client.poll().has_value());
  wire.sent.clear();
  client.write(0x0044, std::vector<uint16_t>{0x0019, 0xF0A0});
  client.poll();
  check_bytes(framed({1, 16, 0x00, 0x44, 0x00, 0x02, 4, 0x00, 0x19, 0xF0, 0xA0}), wire.sent);
  wire.answer({1, 16, 0x00, 0x44, 0x00, 0x02});
  TEST_ASSERT_TRUE(client.poll().has_value());
}

TEST_F(Asking, an_answer_may_come_byte_by_byte_and_the_request_go_likewise) {
  client.read(0, 1);
  const Bytes answer = framed({1, 3, 2, 0xAB, 0xCD});
  for (int i = 0; i < 8; ++i) {
    wire.room = 1;
    TEST_ASSERT_FALSE(client.poll().has_value());
  }
  TEST_ASSERT_EQUAL_UINT32(8, wire.sent.size());
  for (size_t i = 0; i < answer.size(); ++i) {
    wire.coming.push_back(answer[i]);
    TEST_ASSERT_TRUE(client.poll().has_value() == (i + 1 == answer.size()));
  }
}

TEST_F(Asking, an_exception_is_an_answer) {
  client.read(0x7000, 1);
  wire.answer({1, 0x83, 2});
  const auto answer = client.poll();
  TEST_ASSERT_TRUE(answer.has_value());
  TEST_ASSERT_EQUAL_UINT32(2, answer->exception);
}

TEST_F(Asking, what_does_not_answer_the_request_is_refused_by_name) {
  const Bytes strangers[] = {{2, 3, 2, 0, 0}, {1, 4, 2, 0, 0}, {1, 3, 4, 0, 0, 0, 0}};
  for (const Bytes& stranger : strangers) {
    Asking fresh;
    fresh.client.read(0, 1);
    fresh.wire.answer(stranger);
    TEST_ASSERT_TRUE(refuses(fresh.client));
  }
  client.read(0, 1);
  wire.answer({1, 3, 2, 0, 0});
  wire.coming[4] ^= 1;
  TEST_ASSERT_TRUE(refuses(client));
}

TEST_F(Asking, a_repeated_request_forgets_half_an_answer) {
  client.read(0, 1);
  wire.coming = {1, 3, 2};
  TEST_ASSERT_FALSE(client.poll().has_value());
  client.repeat();
  wire.answer({1, 3, 2, 0x00, 0x07});
  const auto answer = client.poll();
  TEST_ASSERT_TRUE(answer.has_value());
  TEST_ASSERT_EQUAL_UINT32(7, answer->registers[0]);
  TEST_ASSERT_EQUAL_UINT32(16, wire.sent.size());
}
