// SPDX-License-Identifier: Apache-2.0
#include "firmware/target/stm32f405/usart.hpp"

namespace stillpoint::stm32f405 {

void set_up_usart(Usart& usart, uint32_t clock_hz, const firmware::LineSettings& line) {
  const uint32_t divider = (clock_hz + line.baud / 2) / line.baud;  // clock cycles a bit
  using firmware::LineFormat;
  const bool odd = line.format == LineFormat::k8O1;
  const bool parity = odd || line.format == LineFormat::k8E1;
  const uint32_t framing =
      (parity ? Usart::kCr1ParityOn | Usart::kCr1NineBits : 0u) | (odd ? Usart::kCr1ParityOdd : 0u);
  uint32_t oversampling = 0;
  usart.CR1 = 0;
  usart.CR2 = line.format == LineFormat::k8N2 ? Usart::kCr2TwoStops : 0u;
  if (divider >= 16) {
    usart.BRR = divider;
  } else {  // RM0090 30.3.4: with 8 samples a bit the fraction has three bits, and bit 3 stays 0
    usart.BRR = (divider & ~7u) << 1 | (divider & 7u);
    oversampling = Usart::kCr1OversampleBy8;
  }
  usart.CR1 = framing | oversampling | Usart::kCr1UsartOn | Usart::kCr1ReceiveOn | Usart::kCr1TransmitOn |
              Usart::kCr1ReceiveInterrupt;
}

}  // namespace stillpoint::stm32f405
