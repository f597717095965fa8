// SPDX-License-Identifier: Apache-2.0
// The reading half of the register bank: what the drive shows of one tick.
#include "firmware/register_bank.hpp"

namespace stillpoint::firmware {
namespace {

// What is read beside the table.
enum class Window : uint8_t { kNone, kFaultHistory, kScope };

Window window_at(uint32_t address) {
  if (address >= kFirstScopeWord && address < kFirstScopeWord + 2 * kScopePage) return Window::kScope;
  if (address >= kFirstFaultEntry && address < kFirstFaultEntry + kFaultEntries * kFaultEntryStride)
    return Window::kFaultHistory;
  return Window::kNone;
}

}  // namespace

uint16_t RegisterBank::word_at(uint16_t address) const {
  if (window_at(address) == Window::kScope) return parts_.scope->word(uint32_t{address} - kFirstScopeWord);
  if (window_at(address) == Window::kFaultHistory) {
    const uint32_t at = uint32_t{address} - kFirstFaultEntry;
    return parts_.faults->word(at / kFaultEntryStride, at % kFaultEntryStride);
  }
  const size_t index = find_parameter(address);
  const uint32_t value = parts_.parameters->value(index);
  const bool high = kParameters[index].words() == 2 && address == address_of(kParameters[index].name);
  return static_cast<uint16_t>(high ? value >> 16 : value);
}

ModbusException RegisterBank::read(uint16_t first, uint32_t count, uint16_t* words) {
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t address = first + i;
    if (window_at(address) != Window::kNone) continue;
    if (address > UINT16_MAX || find_parameter(static_cast<uint16_t>(address)) == kNoParameter) {
      return ModbusException::kIllegalAddress;
    }
  }
  if (window_at(first) == Window::kScope && !parts_.scope->full()) return ModbusException::kDeviceBusy;
  refresh();
  parts_.scope->show();
  const bool of_tuning =
      first + count > address_of(Register::kTuneState) && first <= address_of(Register::kTuneExcitedBy);
  if (of_tuning) parts_.tuner->show();
  for (uint32_t i = 0; i < count; ++i) words[i] = word_at(static_cast<uint16_t>(first + i));
  return ModbusException::kNone;
}

void RegisterBank::refresh() {
  const LoopSnapshot& loop = parts_.drive->loop();
  uint32_t warnings = loop.feedback_valid ? 0 : kWarningFeedbackMissing;
  if (loop.link_silent) warnings |= kWarningLinkSilent;
  if (parts_.shaper->restoring()) warnings |= kWarningNotRestored;
  const bool beyond = parts_.loop->beyond_limit(loop.position) != 0;
  if (beyond) warnings |= kWarningBeyondLimit;
  const uint32_t shown_bits = (warnings != 0 ? kStatusWarning : 0U) | (beyond ? kStatusInternalLimit : 0U);
  Parameters& parameters = *parts_.parameters;
  parameters.set(Register::kUptimeMs, uptime_ms_);
  parameters.set(Register::kErrorCode, static_cast<uint32_t>(loop.fault));
  parameters.set(Register::kWarnings, warnings);
  parameters.set(Register::kServoTicks, loop.ticks);
  parameters.set(Register::kServoMissing, loop.missing);
  parameters.set(Register::kServoLinkLosses, loop.link_losses);
  parameters.set(Register::kTickOverruns, loop.overruns);
  parameters.set(Register::kStatusword, parts_.drive->statusword() | shown_bits);
  const auto buffered = static_cast<uint32_t>(parts_.stream->buffered());
  parameters.set(Register::kStreamBuffered, buffered);
  parameters.set(Register::kStreamRoom, kStreamPositions - buffered);
  parameters.set(Register::kStreamLimitedTicks, parts_.axis->stream_state().limited_ticks);
  parameters.set(Register::kStreamUnderruns, parts_.stream->underruns());
  refresh_motion(loop);
}

void RegisterBank::refresh_motion(const LoopSnapshot& loop) {
  Parameters& parameters = *parts_.parameters;
  parameters.set_signed(Register::kActualPosition, counts_from_signal(loop.position));
  parameters.set_signed(Register::kDemandBeforeShaping, counts_from_signal(loop.axis.demand));
  parameters.set_signed(Register::kDemandAfterShaping, counts_from_signal(loop.axis.setpoint));
  parameters.set_signed(Register::kFollowingError, following_error(loop));
  parameters.set_signed(Register::kActualVelocity, counts_per_second(loop.position_change, ticks_per_second_));
}

}  // namespace stillpoint::firmware
