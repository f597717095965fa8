// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

namespace stillpoint::hal {

// Positions are counts times 2^32 (signed, [-2^31, 2^31 - 1] counts).
struct ServoCommand {
  int64_t setpoint;
  bool enabled;  // the drive may hold torque
};

struct ServoFeedback {
  int64_t position;      // encoder, counts * 2^32
  int32_t acceleration;  // tip accelerometer, raw; 0 where there is none
  uint16_t sequence;     // rises by one each tick; a gap is a missed tick
  bool valid;            // the position may be used
  bool commit;           // results of the background may take effect at the next tick: the command that answers this
                         // feedback is made before it is read
};

// The way to the servo drive. Called once a tick, from the tick's context: hands over the command of this tick and
// returns the newest feedback. Must not wait for more than the rest of the tick.
class ServoPort {
 public:
  virtual ServoFeedback exchange(const ServoCommand& command) = 0;

  // The drive may hold torque no longer, said where no exchange comes: when the link is dead. Same context.
  virtual void disable() = 0;

 protected:
  ~ServoPort() = default;
};

}  // namespace stillpoint::hal
