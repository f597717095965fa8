// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "firmware/line_settings.hpp"
#include "firmware/target/stm32f405/registers.hpp"

namespace stillpoint::stm32f405 {

// Switches the USART on, sending and receiving, with its receive interrupt. `clock_hz` is its bus's. Divides by the
// nearest the register can do. The clocks of clock.hpp make 2 Mbaud exactly, and every one of kBauds within 0.25 % from
// the crystal; the internal oscillator within 1 %, but for 921600 (2.1 %: too much beside its own error).
void set_up_usart(Usart& usart, uint32_t clock_hz, const firmware::LineSettings& line);

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

// For a transceiver that has to be told, after each serve_usart: whether the last bit has gone out. Until then an
// interrupt will come for it.
inline bool has_sent_all(Usart& usart, bool nothing_left) {
  const bool done = nothing_left && (usart.SR & Usart::kSrTransmitComplete) != 0;
  const bool waits = nothing_left && !done;
  usart.CR1 = (usart.CR1 & ~Usart::kCr1CompleteInterrupt) | (waits ? Usart::kCr1CompleteInterrupt : 0u);
  return done;
}

// Any context: setting the bit once too often costs one empty interrupt.
inline void start_sending(Usart& usart, Interrupt interrupt) {
  usart.CR1 = usart.CR1 | Usart::kCr1TransmitInterrupt;
  pend(interrupt);
}

}  // namespace stillpoint::stm32f405
