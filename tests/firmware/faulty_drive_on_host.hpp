// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/firmware/faulty_drive.hpp"

namespace stillpoint::testing {

class FaultyDriveOnHost final : public FaultyDrive {
 public:
  FaultyDriveOnHost() { rig_.enable(); }

  Bytes exchange_with(uint8_t unit, const Bytes& pdu) override { return rig_.exchange_with(unit, pdu); }
  void step_ticks(uint32_t ticks) override { rig_.step(ticks); }
  uint32_t lag() const override { return 0; }
  // The port hands on whole frames alone.
  void damage_frames(uint32_t count) override { servo.sequence = static_cast<uint16_t>(servo.sequence + count); }
  void stay_silent(uint32_t ms) override { rig_.step_silent(ms); }
  uint32_t ticks_in(uint32_t ms) const override { return ms; }
  void note(firmware::FaultCode fault) override {
    if (fault != firmware::FaultCode::kTickOverrun) return rig_.drive.note_fault(fault), rig_.step();
    for (int i = 0; i < 2; ++i) {
      rig_.step();
      rig_.drive.note_overrun();
    }
  }

 private:
  Drive402 rig_{servo};
};

}  // namespace stillpoint::testing
