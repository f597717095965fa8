// SPDX-License-Identifier: Apache-2.0
#include "firmware/modbus_rtu.hpp"
#include "tests/firmware/rig.hpp"

using namespace stillpoint::firmware;
using namespace stillpoint::testing;

namespace {

struct Framing {
  Line line;
  RtuPort port;
  uint32_t now = UINT32_MAX - 20;  // so that the clock wraps under the tests

  Framing() { port.begin(line, 17, 3); }

  void send(const Bytes& bytes) { line.to_drive.insert(line.to_drive.end(), bytes.begin(), bytes.end()); }
  bool poll_for(uint32_t ticks) {
    bool complete = port.poll(now);
    for (uint32_t i = 0; i < ticks && !complete; ++i) complete = port.poll(++now);
    return complete;
  }
  void answer(const Bytes& pdu) {
    for (size_t i = 0; i < pdu.size(); ++i) port.response()[i] = pdu[i];
    port.reply(pdu.size());
  }
};

const Bytes kReadOne = {17, 3, 0x00, 0x41, 0x00, 0x01};

TEST_F(Framing, a_frame_is_complete_after_three_ticks_of_silence_whatever_the_clock_says) {
  for (uint32_t before_wrap = 5; before_wrap != UINT32_MAX - 5; --before_wrap) {
    TEST_INFO("ticks before the clock wraps", before_wrap);
    now = UINT32_C(0) - before_wrap;
    send(framed(kReadOne));
    TEST_ASSERT_FALSE(port.poll(now));
    TEST_ASSERT_FALSE(port.poll(now + 1));
    TEST_ASSERT_FALSE(port.poll(now + 2));
    TEST_ASSERT_TRUE(port.poll(now + 3));
    TEST_ASSERT_EQUAL_UINT32(5, port.request_length());
    TEST_ASSERT_EQUAL_UINT32(3, port.request()[0]);
    TEST_ASSERT_EQUAL_UINT32(1, port.request()[4]);
    answer({3, 2, 0, 0});
  }
}

TEST_F(Framing, the_answer_carries_unit_and_crc) {
  send(framed(kReadOne));
  TEST_ASSERT_TRUE(poll_for(5));
  answer({3, 2, 0x12, 0x34});
  TEST_ASSERT_TRUE(line.from_drive == framed({17, 3, 2, 0x12, 0x34}));
}

TEST_F(Framing, short_gaps_inside_a_frame_are_accepted) {
  const Bytes frame = framed(kReadOne);
  for (const uint8_t byte : frame) {
    send({byte});
    TEST_ASSERT_FALSE(port.poll(now));
    TEST_ASSERT_FALSE(port.poll(now + 2));
    now += 2;
  }
  TEST_ASSERT_TRUE(poll_for(3));
}

TEST_F(Framing, a_long_gap_cuts_a_frame_in_two_broken_ones) {
  const Bytes frame = framed(kReadOne);
  send(Bytes(frame.begin(), frame.begin() + 4));
  TEST_ASSERT_FALSE(poll_for(5));
  send(Bytes(frame.begin() + 4, frame.end()));
  TEST_ASSERT_FALSE(poll_for(5));
  TEST_ASSERT_EQUAL_UINT32(2, port.counters().crc_errors);
  TEST_ASSERT_EQUAL_UINT32(0, port.counters().requests);
}

TEST_F(Framing, frames_without_silence_between_are_one_broken_frame_and_the_next_is_heard) {
  send(framed(kReadOne));
  send(framed(kReadOne));
  TEST_ASSERT_FALSE(poll_for(5));
  TEST_ASSERT_EQUAL_UINT32(1, port.counters().crc_errors);
  send(framed(kReadOne));
  TEST_ASSERT_TRUE(poll_for(5));
}

TEST_F(Framing, every_single_bit_error_is_dropped_in_silence) {
  const Bytes good = framed(kReadOne);
  uint32_t dropped = 0;
  for (size_t byte = 0; byte < good.size(); ++byte) {
    for (int bit = 0; bit < 8; ++bit) {
      TEST_INFO("byte", byte);
      TEST_INFO("bit", bit);
      Bytes bad = good;
      bad[byte] = static_cast<uint8_t>(bad[byte] ^ (1 << bit));
      send(bad);
      TEST_ASSERT_FALSE(poll_for(5));
      TEST_ASSERT_EQUAL_UINT32(++dropped, port.counters().crc_errors);
    }
  }
  TEST_ASSERT_TRUE(line.from_drive.empty());
}

TEST_F(Framing, another_unit_is_not_answered) {
  for (const int unit : {1, 16, 18, 247, 248, 255}) {
    TEST_INFO("unit", unit);
    send(framed({static_cast<uint8_t>(unit), 3, 0, 0x41, 0, 1}));
    TEST_ASSERT_FALSE(poll_for(5));
  }
  TEST_ASSERT_EQUAL_UINT32(6, port.counters().others);
}

TEST_F(Framing, a_broadcast_is_executed_and_not_answered) {
  send(framed({0, 6, 0, 0x40, 0, 0}));
  TEST_ASSERT_TRUE(poll_for(5));
  answer({6, 0, 0x40, 0, 0});
  TEST_ASSERT_TRUE(line.from_drive.empty());
  TEST_ASSERT_FALSE(port.sending());
}

TEST_F(Framing, runts_are_counted_and_forgotten) {
  for (const Bytes& runt : {Bytes{17}, Bytes{17, 3}, Bytes{0xFF, 0xFF, 0xFF}, framed({17})}) {
    send(runt);
    TEST_ASSERT_FALSE(poll_for(5));
  }
  TEST_ASSERT_EQUAL_UINT32(4, port.counters().runts);
  send(framed(kReadOne));
  TEST_ASSERT_TRUE(poll_for(5));
}

TEST_F(Framing, a_frame_of_256_bytes_is_taken_and_one_of_257_is_not) {
  Bytes body(254, 0x55);
  body[0] = 17;
  send(framed(body));
  TEST_ASSERT_TRUE(poll_for(20));
  TEST_ASSERT_EQUAL_UINT32(253, port.request_length());
  answer({0xD5, 1});
  body.push_back(0x55);
  send(framed(body));
  TEST_ASSERT_FALSE(poll_for(20));
  TEST_ASSERT_EQUAL_UINT32(1, port.counters().oversize);
  send(Bytes(5000, 17));
  TEST_ASSERT_FALSE(poll_for(200));
  TEST_ASSERT_EQUAL_UINT32(2, port.counters().oversize);
}

TEST_F(Framing, a_line_that_takes_a_byte_now_and_then_gets_the_answer_in_order_and_nothing_waits) {
  line.room = 0;
  send(framed(kReadOne));
  TEST_ASSERT_TRUE(poll_for(5));
  answer({3, 2, 0xAB, 0xCD});
  TEST_ASSERT_TRUE(port.sending());
  for (int byte = 1; byte <= 7; ++byte) {
    line.room = 1;
    TEST_ASSERT_FALSE(port.poll(++now));
    TEST_ASSERT_EQUAL_UINT32(byte, line.from_drive.size());
  }
  TEST_ASSERT_FALSE(port.sending());
  TEST_ASSERT_TRUE(line.from_drive == framed({17, 3, 2, 0xAB, 0xCD}));
}

TEST_F(Framing, a_request_that_comes_while_the_answer_goes_out_is_taken_after_it) {
  line.room = 0;
  send(framed(kReadOne));
  TEST_ASSERT_TRUE(poll_for(5));
  answer({3, 2, 0xAB, 0xCD});
  send(framed(kReadOne));
  TEST_ASSERT_FALSE(poll_for(10));
  line.room = SIZE_MAX;
  TEST_ASSERT_TRUE(poll_for(1));
}

}  // namespace
