// SPDX-License-Identifier: Apache-2.0
// The conformance table on the host, and what needs more than a question and an answer: the counters, continued
// identification, broadcasts and motion.
#include "firmware/modbus_identification.hpp"
#include "tests/firmware/drive402.hpp"
#include "tests/firmware/modbus_conformance.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;
using firmware::ModbusException;

namespace {

constexpr uint32_t kLongestFrameTicks = 40;

TEST_F(Rig, every_row_of_the_conformance_table_is_answered_byte_for_byte) {
  const ConformanceTable table;
  size_t rows = 0;
  for (const ConformanceGroup& group : table.groups()) {
    TEST_INFO("group", group.name);
    for (size_t i = 0; i < group.rows.size(); ++i, ++rows) {
      TEST_INFO("row", i);
      const ConformanceRow& row = group.rows[i];
      line.from_drive.clear();
      send(row.frame);
      step(kLongestFrameTicks);
      TEST_ASSERT_TRUE(line.from_drive == (row.answer.empty() ? Bytes{} : framed(row.answer)));
    }
  }
  TEST_ASSERT_AT_LEAST_INT64(400, rows);
  for (const hal::ServoCommand& command : servo.commands) TEST_ASSERT_FALSE(command.enabled);
}

struct Counting : Rig {
  uint32_t counter(uint8_t sub) {
    const Bytes response = exchange({8, 0, sub, 0, 0});
    TEST_ASSERT_EQUAL_UINT32(5, response.size());
    return static_cast<uint32_t>((response[3] << 8) | response[4]);
  }
  void drop(const Bytes& frame) {
    send(frame);
    step(kLongestFrameTicks);
    TEST_ASSERT_TRUE(line.from_drive.empty());
  }
};

// Each question counts itself among the bus's and the slave's messages.
TEST_F(Counting, the_counters_are_those_of_the_serial_line_guide) {
  exchange({8, 0, 10, 0, 0});
  TEST_ASSERT_EQUAL_UINT32(1, counter(11));
  TEST_ASSERT_EQUAL_UINT32(2, counter(14));
  drop(framed({9, 3, 0, 6, 0, 2}));  // for another
  TEST_ASSERT_EQUAL_UINT32(4, counter(11));
  TEST_ASSERT_EQUAL_UINT32(4, counter(14));
  drop({1, 3, 0, 6, 0, 2, 0, 0});
  drop({1, 3});
  drop(Bytes(300, 1));
  TEST_ASSERT_EQUAL_UINT32(3, counter(12));
  TEST_ASSERT_EQUAL_UINT32(1, counter(18));
  exchange({99});
  exchange({6, 0x00, 0x14, 0x53, 0x41});
  drop(framed({0, 99}));  // an error too, though nobody is told
  TEST_ASSERT_EQUAL_UINT32(3, counter(13));
  TEST_ASSERT_EQUAL_UINT32(1, counter(17));
  TEST_ASSERT_EQUAL_UINT32(1, counter(15));
  TEST_ASSERT_EQUAL_UINT32(0, counter(16));
  TEST_ASSERT_EQUAL_UINT32(14, counter(14));
}

TEST_F(Counting, clearing_and_restarting_begin_again_and_the_drives_own_go_on) {
  for (const uint8_t sub : Bytes{1, 10}) {
    drop({1, 3, 0, 0, 0, 0, 0, 0});
    exchange({99});
    drop(framed({0, 3, 0, 6, 0, 2}));
    exchange({8, 0, sub, 0, 0});
    for (const uint8_t counted : Bytes{12, 13, 15, 16, 17, 18}) TEST_ASSERT_EQUAL_UINT32(0, counter(counted));
    TEST_ASSERT_EQUAL_UINT32(7, counter(14));
  }
  TEST_ASSERT_EQUAL_UINT32(2, drive.client_counters().crc_errors);
}

TEST_F(Counting, what_is_only_listened_to_counts_as_unanswered_until_the_restart_clears_it) {
  exchange({8, 0, 10, 0, 0});
  drop(framed({1, 8, 0, 4, 0, 0}));
  drop(framed({1, 6, 0x01, 0x00, 0, 3}));
  TEST_ASSERT_EQUAL_UINT32(2, drive.client_counters().unanswered);
  drop(framed({0, 8, 0, 1, 0, 0}));          // a broadcast does it too
  TEST_ASSERT_EQUAL_UINT32(1, counter(15));  // that broadcast's own reply, which is none
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0100));
}

// The server by itself, on a drive that is off.
struct Served {
  Axis<16> axis;
  firmware::Parameters parameters = {};
  firmware::ControlLoop loop = {};
  firmware::PositionStream stream = {};
  firmware::ShaperSettings shaper = {};
  firmware::Drive drive = {};
  firmware::RegisterBank registers = {};
  firmware::ParameterKeeper keeper = {};
  firmware::ModbusServer server = {};
  firmware::RtuPort port = {};
  Servo servo;
  Line line;

  Served() {
    TEST_ASSERT_OK(axis.configure(firmware::kDefaultAxis));
    parameters.load_defaults();
    loop.begin(axis, servo);
    drive.begin(axis, loop, parameters, stream);
    shaper.begin(axis, parameters, Meanwhile{});
    const firmware::RegisterBank::Parts parts = {&axis,       &loop,   &drive,  &shaper, nullptr,
                                                 &parameters, nullptr, &stream, nullptr, &keeper};
    registers.begin(parts);
    keeper.begin(parts, registers, nullptr, nullptr);
    server.begin(registers);
    port.begin(line, 1, 2);
    drive.service();
  }
  bool acts_on(const Bytes& pdu, uint8_t unit = 1) {
    Bytes body{unit};
    body.insert(body.end(), pdu.begin(), pdu.end());
    const Bytes frame = framed(body);
    line.to_drive.insert(line.to_drive.end(), frame.begin(), frame.end());
    TEST_ASSERT_FALSE(port.poll(0));
    TEST_ASSERT_TRUE(port.poll(5));
    return server.serve(port);
  }
};

// The client's watchdog (0023) goes by it.
TEST_F(Served, what_is_only_listened_to_is_no_sign_of_a_client_that_is_in_control) {
  const Bytes disable = {6, 0, 0x40, 0, 0};
  TEST_ASSERT_TRUE(acts_on(disable));
  TEST_ASSERT_TRUE(acts_on(disable, 0));
  TEST_ASSERT_TRUE(acts_on({99}));  // refused
  TEST_ASSERT_TRUE(acts_on({8, 0, 4, 0, 0}));
  TEST_ASSERT_FALSE(acts_on(disable));
  TEST_ASSERT_FALSE(acts_on(disable, 0));
  TEST_ASSERT_FALSE(acts_on({8, 0, 1, 0, 7}));
  TEST_ASSERT_TRUE(acts_on({8, 0, 1, 0, 0}));
  TEST_ASSERT_TRUE(acts_on(disable));
}

TEST_F(Counting, a_counter_wraps_at_16_bits) {
  exchange({8, 0, 10, 0, 0});
  for (int i = 0; i < 65535; ++i) {
    send({1});
    step(4);
  }
  TEST_ASSERT_EQUAL_UINT32(65535, counter(12));
  drop({1});
  TEST_ASSERT_EQUAL_UINT32(0, counter(12));
}

TEST(an_identification_that_does_not_fit_says_where_it_goes_on) {
  const std::string text(100, 'x');
  const firmware::modbus::DeviceObject objects[] = {
      {0, text.c_str()}, {1, text.c_str()}, {2, text.c_str()}, {0x80, text.c_str()}};
  const auto ask = [&](const Bytes& request) {
    uint8_t response[firmware::kMaxPduBytes];
    firmware::modbus::Exchange exchange = {request.data(), request.size(), response, 0, {}};
    TEST_ASSERT_EQUAL_ENUM(ModbusException::kNone, firmware::modbus::read_device_identification(objects, 4, exchange));
    return Bytes(response, response + exchange.written);
  };
  const Bytes first = ask({43, 14, 3, 0});
  TEST_ASSERT_EQUAL_UINT32(7 + 2 * 102, first.size());
  TEST_ASSERT_TRUE(Bytes(first.begin(), first.begin() + 9) == Bytes({43, 14, 3, 0x82, 0xFF, 2, 2, 0, 100}));
  const Bytes second = ask({43, 14, 3, 2});
  TEST_ASSERT_TRUE(Bytes(second.begin(), second.begin() + 8) == Bytes({43, 14, 3, 0x82, 0, 0, 2, 2}));
  TEST_ASSERT_EQUAL_UINT32(0x80, second[7 + 102]);
  const Bytes basic = ask({43, 14, 1, 2});
  TEST_ASSERT_EQUAL_UINT32(1, basic[6]);
}

struct Told : Enabled402 {
  void tell_all(uint32_t address, uint32_t word) {
    Bytes body{0, 6};
    append_word(body, address);
    append_word(body, word);
    send(framed(body));
    step(20);
    TEST_ASSERT_TRUE(line.from_drive.empty());
  }
  int64_t moved_in(uint32_t ticks) {
    const int64_t before = servo.setpoint();
    step(ticks);
    return servo.setpoint() - before;
  }
};

TEST_F(Told, a_broadcast_never_starts_a_move) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, 500000));
  for (const uint32_t word : {0x1FU, 0x3FU, 0x5FU, 0x11FU, 0x0FU}) {
    TEST_INFO("controlword", word);
    tell_all(0x0040, word);
    TEST_ASSERT_EQUAL_UINT32(0x8700, get(0x0012));
    TEST_ASSERT_EQUAL_INT64(0, moved_in(200));
    TEST_ASSERT_EQUAL_UINT32(0x0027, state());
  }
  control(0x1F);  // but a unit's own does
  TEST_ASSERT_TRUE(moved_in(200) != 0);
}

TEST_F(Told, a_broadcast_does_not_retarget_what_moves) {
  start_move(1000000);
  step(100);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, -1000000));
  control(0x0F);
  for (const uint32_t word : {0x3FU, 0x37U, 0x33U, 0x3BU}) tell_all(0x0040, word);
  send(framed({0, 16, 0x00, 0x44, 0, 2, 4, 0, 0, 0, 0}));
  step(2000);
  TEST_ASSERT_EQUAL_INT64(1000000 * kCount, servo.setpoint());
  TEST_ASSERT_EQUAL_INT32(-1000000, get_wide(0x0044));
}

TEST_F(Told, a_broadcast_stops) {
  for (const uint32_t word : {0x10FU, 0x07U, 0x02U, 0x06U, 0x00U}) {
    TEST_INFO("controlword", word);
    Told other;
    other.start_move(1000000);
    other.step(200);
    TEST_ASSERT_TRUE(other.moved_in(1) != 0);
    other.tell_all(0x0040, word);
    other.step(1000);
    TEST_ASSERT_EQUAL_INT64(0, other.moved_in(1000));
    TEST_ASSERT_TRUE(other.servo.setpoint() < 1000000 * kCount);
  }
}

TEST_F(Drive402, a_broadcast_readies_and_switches_on_but_does_not_enable) {
  for (const uint8_t word : Bytes{0x06, 0x07, 0x0F}) {
    send(framed({0, 6, 0x00, 0x40, 0x00, word}));
    step(20);
  }
  TEST_ASSERT_EQUAL_UINT32(0x0023, state());
  send(framed({0, 6, 0x00, 0x40, 0x01, 0x0F}));
  step(20);
  TEST_ASSERT_EQUAL_UINT32(0x0023, state());
  for (const hal::ServoCommand& command : servo.commands) TEST_ASSERT_FALSE(command.enabled);
}

}  // namespace
