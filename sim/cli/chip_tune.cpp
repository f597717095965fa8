// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/chip_tune.hpp"

#include <memory>

#include "firmware/parameters.hpp"
#include "firmware/registers.hpp"
#include "sim/cli/chip_client.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/cli/tune_output.hpp"
#include "sim/hil/session.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::FoundField;
using firmware::ModeField;
using firmware::Register;
using firmware::TuneCommand;

// With -icount shift=3 an instruction takes 8 ns of the chip's millisecond.
constexpr uint64_t kInstructionsPerTick = 125000;
// Seven minutes of the drive's time.
constexpr uint64_t kTunePatienceTicks = 400000;

// The drive, and all it was told and sensed.
class RecordingPort final : public hal::ServoPort {
 public:
  explicit RecordingPort(const sim::SimulatedDriveConfig& config) : drive_(config) {}

  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    const hal::ServoFeedback feedback = drive_.exchange(command);
    ticks.push_back({state, command.setpoint, drive_.tip_position(), drive_.tip_acceleration(), feedback.position,
                     feedback.acceleration});
    return feedback;
  }
  void disable() override {}

  std::vector<sim::TuneTick> ticks;
  TuneState state = TuneState::kIdle;

 private:
  sim::SimulatedDrive drive_;
};

class TuningClient {
 public:
  TuningClient(sim::Session& session, RecordingPort& port, Progress& progress)
      : session_(session), client_(session), port_(port), progress_(progress) {}

  void start(const TuneJob& job) {
    client_.enable();
    client_.set_move(registers_of(job.moves.shaped));
    const TuneRegisters registers = tune_registers_of(job.task);
    client_.write(Register::kTuneExcitation, registers.excitation);
    client_.write32(Register::kTuneAmplitude, registers.amplitude);
    client_.write32(Register::kTuneTravel, registers.travel);
    client_.write(Register::kTuneBandLow, registers.band_low);
    client_.write(Register::kTuneBandHigh, registers.band_high);
    client_.write(Register::kTuneSourceWanted, registers.source);
    client_.write(Register::kTuneTolerance, registers.tolerance);
    client_.write32(Register::kTuneSensorLowest, static_cast<uint32_t>(-registers.sensor_highest));
    client_.write32(Register::kTuneSensorHighest, static_cast<uint32_t>(registers.sensor_highest));
    command(TuneCommand::kStart);
  }

  void run_to_its_end() {
    client_.wait(
        "the end of the tuning", [this] { return ended(); }, kTunePatienceTicks);
  }

  Announcement announced() {
    const double jerk = firmware::kJerkUnit;
    return {1.0 * client_.read32(Register::kTuneTravelAnnounced),
            1.0 * client_.read32(Register::kTuneVelocityAnnounced),
            1.0 * client_.read32(Register::kTuneAccelerationAnnounced),
            jerk * client_.read32(Register::kTuneJerkAnnounced), 1e-3 * client_.read32(Register::kTuneDurationMs)};
  }

  TuneReport report();
  std::vector<sim::SpecifiedShaper> shapers();
  uint64_t identifying_ticks() const { return identifying_ticks_; }
  uint32_t missing_ticks() { return client_.read32(Register::kServoMissing); }

 private:
  void command(TuneCommand command) {
    try {
      client_.write(Register::kTuneCommand, static_cast<uint16_t>(command));
    } catch (const sim::Refusal& refusal) {
      if (refusal.result() != "client_refused") throw;
      client_.refuse_with_reason();
    }
  }

  bool ended() {
    const auto state = static_cast<TuneState>(client_.read(Register::kTuneState));
    if (port_.state == TuneState::kIdentifying) identifying_ticks_ += session_.ticks() - seen_at_;
    seen_at_ = session_.ticks();
    port_.state = state;
    progress_.update(client_.read(Register::kTuneProgress) / 100.0);
    if (state == TuneState::kProposed) command(TuneCommand::kAccept);
    return state == TuneState::kKept || state == TuneState::kUndone || state == TuneState::kFailed ||
           state == TuneState::kIdle;
  }

  IdentifiedMode mode(uint32_t k);

  sim::Session& session_;
  ChipClient client_;
  RecordingPort& port_;
  Progress& progress_;
  uint64_t seen_at_ = 0;
  uint64_t identifying_ticks_ = 0;
};

IdentifiedMode TuningClient::mode(uint32_t k) {
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

TuneReport TuningClient::report() {
  TuneReport report{};
  report.state = port_.state;
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

std::vector<sim::SpecifiedShaper> TuningClient::shapers() {
  std::vector<sim::SpecifiedShaper> specs;
  const uint32_t count = client_.read(Register::kModeCount);
  for (uint32_t k = 0; k < count; ++k) {
    const auto field = [&](ModeField name) { return client_.read(firmware::mode_register(k, name)); };
    ModeRegisters mode{};
    mode.frequency = client_.read32(firmware::mode_register(k, ModeField::kFrequency));
    mode.damping = field(ModeField::kDamping);
    mode.tolerance = field(ModeField::kTolerance);
    mode.kind = field(ModeField::kKind);
    mode.spacing = field(ModeField::kSpacing);
    specs.push_back(specified(mode));
  }
  return specs;
}

ChipTuning tune_once(const std::string& elf, const TuneJob& job, Progress& progress) {
  const std::unique_ptr<sim::Lock> lock = sim::start_locked(elf, sim::Pace::kFreeSysTick);
  RecordingPort port(job.task.drive);
  sim::Session session(*lock, port);
  TuningClient client(session, port, progress);
  ChipTuning tuning{};
  client.start(job);
  tuning.first_announced = in_units(client.announced(), job.task);
  client.run_to_its_end();
  tuning.report = client.report();
  // The registers have amplitudes over the strongest one's already.
  const Identification found = tuning.report.identification;
  tuning.report = in_units(tuning.report, job.task);
  tuning.report.identification = found;
  if (tuning.report.state == TuneState::kKept) tuning.shapers = client.shapers();
  tuning.missing_ticks = client.missing_ticks();
  if (const std::optional<sim::TickCost> cost = lock->cost()) {
    tuning.late_ticks = cost->late_ticks;
    tuning.instructions = kInstructionsPerTick * client.identifying_ticks();
  }
  tuning.ticks = std::move(port.ticks);
  return tuning;
}

}  // namespace

ChipTuning tune_on_chip(const std::string& elf, const TuneJob& job, Progress& progress) {
  return on_a_fast_enough_host([&] { return tune_once(elf, job, progress); });
}

}  // namespace stillpoint::cli
