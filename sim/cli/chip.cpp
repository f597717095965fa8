// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/chip.hpp"

#include <algorithm>

#include "sim/cli/chip_client.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/hil/session.hpp"

namespace stillpoint::cli {
namespace {

// Watches what the chip says, tick by tick.
class Recorder {
 public:
  Recorder(const sim::Lock& lock, Progress& progress) : lock_(lock), progress_(progress) {}

  void expect(uint64_t ticks) { expected_ = ticks; }

  void operator()(const hal::ServoCommand& command) {
    setpoints_.push_back(command.setpoint);
    const size_t ticks = setpoints_.size();
    if (expected_ != 0) progress_.update(std::min(1.0, static_cast<double>(ticks) / static_cast<double>(expected_)));
    const std::optional<sim::TickCost> cost = lock_.cost();
    if (!cost) return;
    late_ticks_ = cost->late_ticks;
    if (ticks < 2 || setpoints_[ticks - 1] == setpoints_[ticks - 2]) return;
    ++counted_;
    instructions_ += cost->instructions;
    most_instructions_ = std::max(most_instructions_, cost->instructions);
  }

  ChipRun result(const MoveReport& report) const {
    ChipRun run{{report, {}}, setpoints_.size(), {}, most_instructions_, late_ticks_};
    size_t first = 1;
    while (first < setpoints_.size() && setpoints_[first] == setpoints_[first - 1]) ++first;
    size_t end = setpoints_.size();
    while (end > first && setpoints_[end - 1] == setpoints_[end - 2]) --end;
    run.recording.setpoints.assign(setpoints_.begin() + static_cast<std::ptrdiff_t>(first - 1),
                                   setpoints_.begin() + static_cast<std::ptrdiff_t>(end));
    if (counted_ != 0) run.instructions_per_tick = static_cast<double>(instructions_) / static_cast<double>(counted_);
    return run;
  }

 private:
  const sim::Lock& lock_;
  Progress& progress_;
  uint64_t expected_ = 0;
  std::vector<Signal> setpoints_;
  uint64_t counted_ = 0;
  uint64_t instructions_ = 0;
  uint32_t most_instructions_ = 0;
  uint32_t late_ticks_ = 0;
};

ChipRun run_once(const std::string& elf, const sim::MoveTask& task, const std::vector<sim::SpecifiedShaper>& specs,
                 const sim::ArmModes& arm, Progress& progress) {
  const std::unique_ptr<sim::Lock> lock = sim::start_locked(elf);
  sim::SimulatedDrive drive = sim::drive_for(task, arm, 0);
  Recorder recorder(*lock, progress);
  sim::Session session(*lock, drive, [&recorder](const hal::ServoCommand& command) { recorder(command); });
  ChipClient client(session);
  client.enable();
  client.set_shaper(registers_of(specs));
  client.set_move(registers_of(task));
  const MoveReport report = client.start();
  recorder.expect(session.ticks() + report.total_ticks);
  for (uint32_t i = 0; i < report.total_ticks; ++i) session.tick();
  client.finish();
  return recorder.result(report);
}

}  // namespace

ChipRun run_on_chip(const std::string& elf, const sim::MoveTask& task, const std::vector<sim::SpecifiedShaper>& specs,
                    const sim::ArmModes& arm, Progress& progress) {
  return on_a_fast_enough_host([&] { return run_once(elf, task, specs, arm, progress); });
}

}  // namespace stillpoint::cli
