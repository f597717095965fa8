// SPDX-License-Identifier: Apache-2.0
// The faults that are provoked, on the host and in the emulator alike, and what of a drive they are provoked on.
#pragma once

#include "tests/firmware/drive402.hpp"

namespace stillpoint::testing {

enum class Cause : uint8_t {
  kInvalid,  // feedbacks that say so
  kStale,    // the same one again and again
  kLost,     // frames that never come
  kDamaged,  // frames that come with a bit turned
  kSilence,  // no sync at all
  kLagging,  // the motor is elsewhere
  kBeyond,   // and beyond a soft limit
  kJump,     // an encoder that moves further than the axis can
  kClientGone,
  // What the emulator has not: on the host they are noted as the chip's ports would.
  kOverrun,
  kWatchdog,
  kStack,
  kParameters,
};

struct Provocation {
  Cause cause;
  firmware::FaultCode fault;
};

constexpr Provocation kProvoked[] = {
    {Cause::kInvalid, firmware::FaultCode::kFeedbackMissing},  {Cause::kStale, firmware::FaultCode::kFeedbackMissing},
    {Cause::kLost, firmware::FaultCode::kFeedbackMissing},     {Cause::kDamaged, firmware::FaultCode::kFeedbackMissing},
    {Cause::kSilence, firmware::FaultCode::kLinkSilent},       {Cause::kLagging, firmware::FaultCode::kFollowingError},
    {Cause::kBeyond, firmware::FaultCode::kPositionLimit},     {Cause::kJump, firmware::FaultCode::kEncoderImplausible},
    {Cause::kClientGone, firmware::FaultCode::kClientSilent},  {Cause::kOverrun, firmware::FaultCode::kTickOverrun},
    {Cause::kWatchdog, firmware::FaultCode::kWatchdog},        {Cause::kStack, firmware::FaultCode::kStackOverflow},
    {Cause::kParameters, firmware::FaultCode::kParametersBad},
};
constexpr size_t kProvokedCount = sizeof kProvoked / sizeof kProvoked[0];
constexpr size_t kProvokedInEmulator = static_cast<size_t>(Cause::kOverrun);  // the first ones

// Beside its servo and its client, whose faults are these two's own.
struct FaultyDrive : Client {
  Servo servo;

  virtual void step_ticks(uint32_t ticks) = 0;
  void step(uint32_t ticks = 1) { step_ticks(ticks); }
  // Ticks from a command to the feedback on it beyond the one that it is given in.
  virtual uint32_t lag() const = 0;
  // Damaged on the way to the drive, which so has no ticks of them.
  virtual void damage_frames(uint32_t count) = 0;
  // That many of the drive's own milliseconds without a tick.
  virtual void stay_silent(uint32_t ms) = 0;
  // Ticks in which at least that many of the drive's own milliseconds go by.
  virtual uint32_t ticks_in(uint32_t ms) const = 0;
  virtual void note(firmware::FaultCode fault) = 0;
};

}  // namespace stillpoint::testing
