// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/tune_client.hpp"

#include "firmware/parameters.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::FoundField;
using firmware::Register;
using firmware::TuneCommand;

// Seven minutes of the drive's time.
constexpr uint64_t kTunePatienceTicks = 400000;

bool is_an_end(TuneState state) {
  return state == TuneState::kKept || state == TuneState::kUndone || state == TuneState::kFailed ||
         state == TuneState::kIdle;
}

}  // namespace

template <typename Write>
void TuneClient::or_with_reason(const Write& write) {
  try {
    write();
  } catch (const sim::RegisterRefusal& refusal) {
    client_.explain(refusal);
  }
}

void TuneClient::start(const TuneRegisters& registers) {
  or_with_reason([&] {
    client_.write(Register::kTuneExcitation, registers.excitation);
    client_.write32(Register::kTuneAmplitude, registers.amplitude);
    client_.write32(Register::kTuneTravel, registers.travel);
    client_.write(Register::kTuneBandLow, registers.band_low);
    client_.write(Register::kTuneBandHigh, registers.band_high);
    client_.write(Register::kTuneSourceWanted, registers.source);
    client_.write(Register::kTuneTolerance, registers.tolerance);
    client_.write32(Register::kTuneSensorLowest, static_cast<uint32_t>(registers.sensor_lowest));
    client_.write32(Register::kTuneSensorHighest, static_cast<uint32_t>(registers.sensor_highest));
  });
  command(TuneCommand::kStart);
}

TuneRegisters TuneClient::registers() {
  TuneRegisters registers{};
  registers.excitation = client_.read(Register::kTuneExcitation);
  registers.amplitude = client_.read32(Register::kTuneAmplitude);
  registers.travel = client_.read32(Register::kTuneTravel);
  registers.band_low = client_.read(Register::kTuneBandLow);
  registers.band_high = client_.read(Register::kTuneBandHigh);
  registers.source = client_.read(Register::kTuneSourceWanted);
  registers.tolerance = client_.read(Register::kTuneTolerance);
  registers.sensor_lowest = static_cast<int32_t>(client_.read32(Register::kTuneSensorLowest));
  registers.sensor_highest = static_cast<int32_t>(client_.read32(Register::kTuneSensorHighest));
  return registers;
}

void TuneClient::command(TuneCommand command) {
  or_with_reason([&] { client_.write(Register::kTuneCommand, static_cast<uint16_t>(command)); });
}

bool TuneClient::has_no_tuner() {
  return client_.read(Register::kRefusalReason) == firmware::kReasonNotAvailable &&
         client_.read(Register::kRefusedRegister) == firmware::address_of(Register::kTuneCommand);
}

TuneState TuneClient::run(const OnState& on_state) {
  TuneState state = TuneState::kIdle;
  const auto enough = [&] {
    state = static_cast<TuneState>(client_.read(Register::kTuneState));
    return on_state(state, client_.read(Register::kTuneProgress) / 100.0) || is_an_end(state);
  };
  client_.wait("the end of the tuning", enough, kTunePatienceTicks);
  return state;
}

Announcement TuneClient::announced() {
  const double jerk = firmware::kJerkUnit;
  return {1.0 * client_.read32(Register::kTuneTravelAnnounced), 1.0 * client_.read32(Register::kTuneVelocityAnnounced),
          1.0 * client_.read32(Register::kTuneAccelerationAnnounced),
          jerk * client_.read32(Register::kTuneJerkAnnounced), 1e-3 * client_.read32(Register::kTuneDurationMs)};
}

IdentifiedMode TuneClient::mode(uint32_t k) {
  const auto field = [&](FoundField name) { return client_.read(firmware::found_register(k, name)); };
  IdentifiedMode mode{};
  mode.frequency_hz = 1e-4 * client_.read32(firmware::found_register(k, FoundField::kFrequency));
  mode.damping_ratio = 1e-5 * field(FoundField::kDamping);
  mode.amplitude = 1e-3 * field(FoundField::kAmplitude);
  mode.frequency_std_hz = 1e-4 * field(FoundField::kFrequencyStd);
  mode.damping_std = 1e-5 * field(FoundField::kDampingStd);
  mode.confidence = 1e-2 * field(FoundField::kConfidence);
  mode.viscous = true;
  return mode;
}

TuneReport TuneClient::report() {
  TuneReport report{};
  report.state = static_cast<TuneState>(client_.read(Register::kTuneState));
  report.progress_percent = client_.read(Register::kTuneProgress);
  report.excited_by = static_cast<TuneExcitation>(client_.read(Register::kTuneExcitedBy));
  report.source = static_cast<TuneSource>(client_.read(Register::kTuneSourceUsed));
  report.source_enough = client_.read(Register::kTuneSourceEnough) != 0;
  report.announced = announced();
  report.identification.finding = static_cast<Finding>(client_.read(Register::kTuneResult));
  report.identification.mode_count = client_.read(Register::kTuneModeCount);
  for (uint32_t k = 0; k < report.identification.mode_count && k < kMostComponents; ++k) {
    report.identification.mode[k] = mode(k);
  }
  report.identification.confidence = report.identification.mode[0].confidence;
  report.flaws.gaps = client_.read32(Register::kTuneGaps);
  report.flaws.saturated = client_.read32(Register::kTuneSaturated);
  report.proposal.residual = 1e-4 * client_.read(Register::kTuneResidual);
  report.proposal.delay_s = 1e-6 * client_.read32(Register::kTuneDelayUs);
  report.proposal.length_s = 1e-6 * client_.read32(Register::kTuneLengthUs);
  report.plain_ringing = 1e-3 * client_.read32(Register::kTunePlainRinging);
  report.shaped_ringing = 1e-3 * client_.read32(Register::kTuneShapedRinging);
  return report;
}

std::vector<sim::SpecifiedShaper> TuneClient::shapers() { return specified(client_.staged_modes()); }

}  // namespace stillpoint::cli
