// SPDX-License-Identifier: Apache-2.0
// The reading half of the register bank: what the drive shows of one tick.
#include "firmware/register_bank.hpp"

namespace stillpoint::firmware {
namespace {

int32_t saturated(int64_t value) {
  if (value > INT32_MAX) return INT32_MAX;
  return value < INT32_MIN ? INT32_MIN : static_cast<int32_t>(value);
}

bool in_fault_history(uint32_t address) {
  return address >= kFirstFaultEntry && address < kFirstFaultEntry + kFaultEntries * kFaultEntryStride;
}

}  // namespace

ModbusException RegisterBank::read(uint16_t first, uint32_t count, uint16_t* words) {
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t address = first + i;
    if (in_fault_history(address)) continue;
    if (address > UINT16_MAX || find_parameter(static_cast<uint16_t>(address)) == kNoParameter) {
      return ModbusException::kIllegalAddress;
    }
  }
  refresh();
  const bool of_tuning =
      first + count > address_of(Register::kTuneState) && first <= address_of(Register::kTuneExcitedBy);
  if (of_tuning) parts_.tuning->show();
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t address = first + i;
    if (in_fault_history(address)) {
      const uint32_t at = address - kFirstFaultEntry;
      words[i] = parts_.faults->word(at / kFaultEntryStride, at % kFaultEntryStride);
      continue;
    }
    const size_t index = find_parameter(static_cast<uint16_t>(address));
    const uint32_t value = parts_.parameters->value(index);
    const bool high = kParameters[index].words() == 2 && address == address_of(kParameters[index].name);
    words[i] = static_cast<uint16_t>(high ? value >> 16 : value);
  }
  return ModbusException::kNone;
}

void RegisterBank::refresh() {
  const LoopSnapshot& loop = parts_.drive->loop();
  uint32_t warnings = loop.feedback_valid ? 0 : kWarningFeedbackMissing;
  if (loop.link_silent) warnings |= kWarningLinkSilent;
  if (parts_.shaper->restoring()) warnings |= kWarningNotRestored;
  Parameters& parameters = *parts_.parameters;
  parameters.set(Register::kUptimeMs, uptime_ms_);
  parameters.set(Register::kErrorCode, static_cast<uint32_t>(loop.fault));
  parameters.set(Register::kWarnings, warnings);
  parameters.set(Register::kServoTicks, loop.ticks);
  parameters.set(Register::kServoMissing, loop.missing);
  parameters.set(Register::kServoLinkLosses, loop.link_losses);
  parameters.set(Register::kTickOverruns, loop.overruns);
  parameters.set(Register::kStatusword, parts_.drive->statusword() | (warnings != 0 ? kStatusWarning : 0U));
  const auto buffered = static_cast<uint32_t>(parts_.stream->buffered());
  parameters.set(Register::kStreamBuffered, buffered);
  parameters.set(Register::kStreamRoom, kStreamPositions - buffered);
  parameters.set(Register::kStreamLimitedTicks, parts_.axis->stream_state().limited_ticks);
  parameters.set(Register::kStreamUnderruns, parts_.stream->underruns());
  refresh_motion(loop);
}

void RegisterBank::refresh_motion(const LoopSnapshot& loop) {
  const int32_t position = counts_from_signal(loop.position);
  const int32_t setpoint = counts_from_signal(loop.axis.setpoint);
  // Half of the fraction goes before the product, so that it fits at any tick rate up to 65 kHz.
  const int64_t velocity = (loop.position_change >> 16) * static_cast<int64_t>(ticks_per_second_) >> 16;
  Parameters& parameters = *parts_.parameters;
  parameters.set_signed(Register::kActualPosition, position);
  parameters.set_signed(Register::kDemandBeforeShaping, counts_from_signal(loop.axis.demand));
  parameters.set_signed(Register::kDemandAfterShaping, setpoint);
  parameters.set_signed(Register::kFollowingError, loop.enabled ? saturated(int64_t{setpoint} - position) : 0);
  parameters.set_signed(Register::kActualVelocity, saturated(velocity));
}

}  // namespace stillpoint::firmware
