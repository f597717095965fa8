// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "firmware/servo_link.hpp"
#include "firmware/target/stm32f405/pins.hpp"
#include "firmware/target/stm32f405/usart.hpp"
#include "hal/servo_port.hpp"

namespace stillpoint::stm32f405 {

// What the port keeps; apart from it so that it stays in .bss (see ClientBuffers).
struct ServoLinkState {
  servo_link::SyncReader reader = {};
  hal::ServoFeedback feedback = {};
  uint8_t reply[servo_link::kReplyBytes] = {};
  size_t unsent = 0;  // of `reply`, from its end
};

// The servo link: USART2 at 2 Mbaud. Everything here runs in USART2's interrupt, the tick included.
//
// A byte takes 5 us, 840 cycles, and the chip keeps just one: whatever else runs at this priority (SysTick's own
// 1 ms) must be shorter than that or a byte is lost, which shows as a gap in the sequence.
class ServoLinkPort final : public hal::ServoPort {
 public:
  explicit constexpr ServoLinkPort(ServoLinkState& state) : state_(state) {}

  void set_up(uint32_t apb1_hz) {
    rcc().APB1ENR = rcc().APB1ENR | Rcc::kApb1Usart2;
    set_up_usart(usart2(), apb1_hz, {kBaud, firmware::LineFormat::k8N1});
    enable(Interrupt::kUsart2, Priority::kTick);
  }

  // Sends the command as the answer to the newest sync and returns that sync. Never waits.
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    set_enable_line(command.enabled);
    servo_link::encode_reply({command, state_.feedback.sequence}, state_.reply);
    state_.unsent = servo_link::kReplyBytes;
    start_sending(usart2(), Interrupt::kUsart2);
    return state_.feedback;
  }

  void disable() override { set_enable_line(false); }

  // True when a sync is complete: time for a tick.
  [[nodiscard]] bool on_interrupt() {
    bool sync = false;
    serve_usart(
        usart2(), [&](uint8_t byte) { sync = state_.reader.push(byte, state_.feedback); },
        [&](uint8_t& byte) {
          if (state_.unsent == 0) return false;
          byte = state_.reply[servo_link::kReplyBytes - state_.unsent--];
          return true;
        });
    return sync;
  }

 private:
  static constexpr uint32_t kBaud = 2000000;

  ServoLinkState& state_;
};

}  // namespace stillpoint::stm32f405
