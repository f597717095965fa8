// SPDX-License-Identifier: Apache-2.0
// The STM32F405's USART service against registers in memory: the orders of events that silicon has and the emulator,
// whose line is always ready, has not.
#include "firmware/target/stm32f405/usart.hpp"

#include <deque>
#include <vector>

#include "tests/support/test.hpp"

namespace {

using namespace stillpoint::firmware;
using namespace stillpoint::stm32f405;

struct Line {
  Usart usart{};
  std::deque<uint8_t> to_send;
  std::vector<uint8_t> received;
  size_t room = SIZE_MAX;  // bytes that the transmitter takes before it is not ready

  Line() { usart.CR1 = Usart::kCr1TransmitInterrupt | Usart::kCr1UsartOn; }

  void interrupt(uint32_t status) {
    usart.SR = status;
    serve_usart(
        usart, [this](uint8_t byte) { received.push_back(byte); },
        [this](uint8_t& byte) {
          if (to_send.empty()) return false;
          byte = to_send.front();
          to_send.pop_front();
          if (--room == 0) usart.SR = 0;
          return true;
        });
  }
  bool transmit_interrupt_on() const { return (usart.CR1 & Usart::kCr1TransmitInterrupt) != 0; }
};

}  // namespace

TEST_F(Line, a_byte_received_is_handed_over_without_its_parity_bit) {
  usart.DR = 0x1A5;
  interrupt(Usart::kSrReceived);
  TEST_ASSERT_EQUAL_UINT32(1, received.size());
  TEST_ASSERT_EQUAL_UINT32(0xA5, received[0]);
}

TEST_F(Line, everything_goes_at_once_into_a_line_that_is_always_ready) {
  to_send = {1, 2, 3};
  interrupt(Usart::kSrTransmitReady);
  TEST_ASSERT_TRUE(to_send.empty());
  TEST_ASSERT_EQUAL_UINT32(3, usart.DR);
}

TEST_F(Line, the_rest_waits_for_the_next_interrupt_when_the_line_is_full) {
  to_send = {1, 2, 3};
  room = 1;
  interrupt(Usart::kSrTransmitReady);
  TEST_ASSERT_EQUAL_UINT32(1, usart.DR);
  TEST_ASSERT_EQUAL_UINT32(2, to_send.size());
  TEST_ASSERT_TRUE(transmit_interrupt_on());
}

TEST_F(Line, an_interrupt_that_was_pended_while_the_line_is_full_changes_nothing) {
  to_send = {1};
  interrupt(0);
  TEST_ASSERT_EQUAL_UINT32(1, to_send.size());
  TEST_ASSERT_TRUE(transmit_interrupt_on());
}

TEST_F(Line, the_interrupt_after_the_last_byte_switches_itself_off) {
  interrupt(Usart::kSrTransmitReady);
  TEST_ASSERT_FALSE(transmit_interrupt_on());
  TEST_ASSERT_TRUE((usart.CR1 & Usart::kCr1UsartOn) != 0);
}

TEST_F(Line, a_byte_received_while_sending_stops_neither) {
  to_send = {7};
  usart.DR = 0x42;
  interrupt(Usart::kSrReceived | Usart::kSrTransmitReady);
  TEST_ASSERT_EQUAL_UINT32(0x42, received[0]);
  TEST_ASSERT_EQUAL_UINT32(7, usart.DR);
  TEST_ASSERT_TRUE(transmit_interrupt_on());
}

TEST_F(Line, an_answer_drives_the_line_until_its_last_bit_is_out) {
  usart.SR = 0;  // the last byte is still in the shift register
  TEST_ASSERT_FALSE(has_sent_all(usart, false));
  TEST_ASSERT_EQUAL_UINT32(0, usart.CR1 & Usart::kCr1CompleteInterrupt);
  TEST_ASSERT_FALSE(has_sent_all(usart, true));
  TEST_ASSERT_TRUE((usart.CR1 & Usart::kCr1CompleteInterrupt) != 0);
  usart.SR = Usart::kSrTransmitComplete;
  TEST_ASSERT_TRUE(has_sent_all(usart, true));
  TEST_ASSERT_EQUAL_UINT32(0, usart.CR1 & Usart::kCr1CompleteInterrupt);
  TEST_ASSERT_TRUE((usart.CR1 & Usart::kCr1UsartOn) != 0);
}

// RM0090 30.3.4: baud = clock / (8 (2 - OVER8) USARTDIV), USARTDIV the mantissa of BRR and 1/16 (OVER8: 1/8) of its low
// four (three) bits.
double baud_of(const Usart& usart, double clock_hz) {
  const bool by_8 = (usart.CR1 & (1U << 15)) != 0;
  const uint32_t brr = usart.BRR;
  const double fraction = by_8 ? (brr & 7U) / 8.0 : (brr & 15U) / 16.0;
  return clock_hz / ((by_8 ? 8.0 : 16.0) * ((brr >> 4) + fraction));
}

TEST(every_rate_is_made_from_the_crystal_and_all_but_the_last_from_the_internal_oscillator) {
  for (const uint32_t baud : kBauds) {
    TEST_INFO("baud", baud);
    Usart usart{};
    set_up_usart(usart, 84000000, {baud, LineFormat::k8E1});
    TEST_ASSERT_DOUBLE_WITHIN(0.0025 * baud, baud, baud_of(usart, 84e6));
    set_up_usart(usart, 16000000, {baud, LineFormat::k8E1});
    TEST_ASSERT_DOUBLE_WITHIN((baud == 921600 ? 0.022 : 0.01) * baud, baud, baud_of(usart, 16e6));
  }
  for (const double clock_hz : {42e6, 16e6}) {  // the servo link
    Usart usart{};
    set_up_usart(usart, static_cast<uint32_t>(clock_hz), {2000000, LineFormat::k8N1});
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 2e6, baud_of(usart, clock_hz));
  }
}

// RM0090 30.6.4 and 30.6.5: M is bit 12 of CR1, PCE bit 10, PS bit 9; STOP bits 13 and 12 of CR2, 10 for two.
TEST(every_format_has_its_bits) {
  struct Case {
    LineFormat format;
    uint32_t cr1, cr2;
  };
  const Case cases[] = {{LineFormat::k8N1, 0, 0},
                        {LineFormat::k8E1, 1U << 12 | 1U << 10, 0},
                        {LineFormat::k8O1, 1U << 12 | 1U << 10 | 1U << 9, 0},
                        {LineFormat::k8N2, 0, 1U << 13}};
  for (const Case& one : cases) {
    Usart usart{};
    usart.CR2 = 3U << 12;
    set_up_usart(usart, 84000000, {115200, one.format});
    TEST_ASSERT_EQUAL_UINT32(one.cr1, usart.CR1 & (1U << 12 | 1U << 10 | 1U << 9));
    TEST_ASSERT_EQUAL_UINT32(one.cr2, usart.CR2);
  }
}

// 3.5 characters of 11 bits, or 1.75 ms above 19200 baud; the clock's steps take up to one away.
TEST(the_silence_that_ends_a_frame_is_the_specifications_at_every_rate) {
  for (const uint32_t baud : kBauds) {
    const double least_ms = baud > 19200 ? 1.75 : 3.5 * 11 * 1000.0 / baud;
    TEST_ASSERT_TRUE(frame_silence_ms(baud) - 1.0 >= least_ms);
    TEST_ASSERT_TRUE(frame_silence_ms(baud) - 2.0 < least_ms);
  }
}
