// SPDX-License-Identifier: Apache-2.0
// expect: protected
#include "hal/servo_port.hpp"

struct Port final : stillpoint::hal::ServoPort {
  stillpoint::hal::ServoFeedback exchange(const stillpoint::hal::ServoCommand&) override { return {}; }
  void disable() override {}
};

void destroy(Port* port);

void destroy(Port* port) {
#ifdef MUST_NOT_COMPILE
  stillpoint::hal::ServoPort* interface = port;
  delete interface;
#else
  delete port;
#endif
}
