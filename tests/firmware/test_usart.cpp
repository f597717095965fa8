// SPDX-License-Identifier: Apache-2.0
// The STM32F405's USART service against registers in memory: the orders of events that silicon has and the emulator,
// whose line is always ready, has not.
#include "firmware/target/stm32f405/usart.hpp"

#include <deque>
#include <vector>

#include "tests/support/test.hpp"

namespace {

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

TEST(the_clocks_of_the_chip_make_the_rates_of_its_lines) {
  struct Case {
    uint32_t clock_hz, baud, brr;
    bool by_8;
  };
  // RM0090 30.3.4: USARTDIV = clock / (8 (2 - OVER8) baud); 12.4 bits, or 12.3 with OVER8.
  const Case cases[] = {{84000000, 115200, 729, false},    // 115226 baud
                        {16000000, 115200, 139, false},    // 115108 baud
                        {42000000, 2000000, 21, false},    // 2 Mbaud
                        {16000000, 2000000, 0x10, true}};  // 2 Mbaud
  for (const Case& one : cases) {
    Usart usart{};
    set_up_usart(usart, one.clock_hz, one.baud, Parity::kNone);
    TEST_ASSERT_EQUAL_UINT32(one.brr, usart.BRR);
    TEST_ASSERT_TRUE(((usart.CR1 & Usart::kCr1OversampleBy8) != 0) == one.by_8);
  }
}
