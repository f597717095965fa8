// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/chip_tune.hpp"

#include <memory>

#include "firmware/registers.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/cli/tune_client.hpp"
#include "sim/cli/tune_output.hpp"
#include "sim/hil/session.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

// With -icount shift=3 an instruction takes 8 ns of the chip's millisecond.
constexpr uint64_t kInstructionsPerTick = 125000;

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

ChipTuning tune_once(const std::string& elf, const TuneJob& job, Progress& progress) {
  const std::unique_ptr<sim::Lock> lock = sim::start_locked(elf, sim::Pace::kFreeSysTick);
  RecordingPort port(job.task.drive);
  sim::Session session(*lock, port);
  TuneClient client(session);
  ChipTuning tuning{};
  client.client().enable();
  client.client().set_move(registers_of(job.moves.shaped));
  client.start(tune_registers_of(job.task));
  tuning.first_announced = in_units(client.announced(), job.task);
  uint64_t identifying_ticks = 0;
  uint64_t seen_at = 0;
  client.run([&](TuneState state, double part_done) {
    if (port.state == TuneState::kIdentifying) identifying_ticks += session.ticks() - seen_at;
    seen_at = session.ticks();
    port.state = state;
    progress.update(part_done);
    if (state == TuneState::kProposed) client.command(firmware::TuneCommand::kAccept);
    return false;
  });
  tuning.report = client.report();
  // The registers have amplitudes over the strongest one's already.
  const Identification found = tuning.report.identification;
  tuning.report = in_units(tuning.report, job.task);
  tuning.report.identification = found;
  if (tuning.report.state == TuneState::kKept) tuning.shapers = client.shapers();
  tuning.missing_ticks = client.client().read32(firmware::Register::kServoMissing);
  if (const std::optional<sim::TickCost> cost = lock->cost()) {
    tuning.late_ticks = cost->late_ticks;
    tuning.instructions = kInstructionsPerTick * identifying_ticks;
  }
  tuning.ticks = std::move(port.ticks);
  return tuning;
}

}  // namespace

ChipTuning tune_on_chip(const std::string& elf, const TuneJob& job, Progress& progress) {
  return on_a_fast_enough_host([&] { return tune_once(elf, job, progress); });
}

}  // namespace stillpoint::cli
