// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "firmware/target/stm32f405/registers.hpp"

namespace stillpoint::stm32f405 {

enum class Parity : uint8_t { kNone, kEven };

// Switches the USART on, sending and receiving, with its receive interrupt. `clock_hz` is its bus's. Divides by the
// nearest the register can do; the clocks of clock.hpp make 115200 within 0.1 % and 2 Mbaud exactly.
void set_up_usart(Usart& usart, uint32_t clock_hz, uint32_t baud, Parity parity);

// One interrupt's work for a USART: the byte received, if any, goes to `receive(uint8_t)`; bytes to send come from
// `next(uint8_t&)`, false when there are none.
//
// A transmit interrupt is asked for by start_sending, through NVIC as well as through TXEIE: QEMU's USART never raises
// one, and there TXE is always set, so the loop sends everything in the one interrupt that was pended. On silicon the
// loop sends a byte or two and the rest follow by TXE; the interrupt after the last byte switches it off. (Silicon's
// side is not tried yet.)
template <typename Receive, typename Next>
inline void serve_usart(Usart& usart, Receive receive, Next next) {
  uint32_t status = usart.SR;
  const bool received = (status & Usart::kSrReceived) != 0;
  // Reading DR after SR also clears a framing, noise or overrun error; the byte is wrong then, which CRCs find.
  if (received) receive(static_cast<uint8_t>(usart.DR & 0xFFu));
  bool sent = false;
  for (uint8_t byte = 0; (status & Usart::kSrTransmitReady) != 0 && next(byte); status = usart.SR) {
    usart.DR = byte;
    sent = true;
  }
  // Nothing done although ready: nothing is left. (Not ready means that a byte is still going out.)
  const bool ready = (status & Usart::kSrTransmitReady) != 0;
  if (ready && !received && !sent) usart.CR1 = usart.CR1 & ~Usart::kCr1TransmitInterrupt;
}

// Any context: setting the bit once too often costs one empty interrupt.
inline void start_sending(Usart& usart, Interrupt interrupt) {
  usart.CR1 = usart.CR1 | Usart::kCr1TransmitInterrupt;
  pend(interrupt);
}

}  // namespace stillpoint::stm32f405
