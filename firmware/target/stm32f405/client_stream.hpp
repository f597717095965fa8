// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "firmware/target/stm32f405/pins.hpp"
#include "firmware/target/stm32f405/usart.hpp"
#include "hal/byte_stream.hpp"
#include "shaper/base/ring_buffer.hpp"

namespace stillpoint::stm32f405 {

// A longest Modbus frame (256 bytes) in either direction. Apart from the stream so that they stay in .bss: an object
// with a virtual function lies in .data, and all its members with it.
struct ClientBuffers {
  RingBuffer<uint8_t, 256> received;
  RingBuffer<uint8_t, 256> to_send;
};

// The Modbus client's line: USART1 behind two ring buffers. A byte that comes while the buffer is full is lost, and the
// frame with it. An RS-485 transceiver is told to drive from the first byte of an answer to its last bit (kDrivePin); a
// gap in an answer lets go of the line for as long, and its bias keeps it idle. (Not run on silicon; the emulator's
// line has no bits.)
class ClientStream final : public hal::ByteStream {
 public:
  explicit constexpr ClientStream(ClientBuffers& buffers) : buffers_(buffers) {}

  void set_up(uint32_t apb2_hz, const firmware::LineSettings& line) {
    rcc().APB2ENR = rcc().APB2ENR | Rcc::kApb2Usart1;
    set_up_usart(usart1(), apb2_hz, line);
    enable(Interrupt::kUsart1, Priority::kClient);
  }

  bool read(uint8_t& byte) override { return buffers_.received.pop(byte); }

  bool write(uint8_t byte) override {
    if (!buffers_.to_send.push(byte)) return false;
    start_sending(usart1(), Interrupt::kUsart1);
    return true;
  }

  void on_interrupt() {
    serve_usart(
        usart1(), [this](uint8_t byte) { static_cast<void>(buffers_.received.push(byte)); },
        [this](uint8_t& byte) {
          if (!buffers_.to_send.pop(byte)) return false;
          set_pin(gpio_a(), kDrivePin, true);
          return true;
        });
    if (has_sent_all(usart1(), buffers_.to_send.empty())) set_pin(gpio_a(), kDrivePin, false);
  }

 private:
  ClientBuffers& buffers_;
};

}  // namespace stillpoint::stm32f405
