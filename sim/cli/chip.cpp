// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/chip.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/registers.hpp"
#include "firmware/state_machine.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/hil/session.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Register;

constexpr uint16_t kShutdown = 0x06;
constexpr uint16_t kSwitchOn = 0x07;
constexpr uint16_t kEnableOperation = 0x0F;
constexpr uint16_t kStateMask = 0x6F;
constexpr uint16_t kOperationEnabled = 0x27;
constexpr uint16_t kApplyAtRest = 1;
// A stalled drive ends the run, a slow one does not: planning takes a few ticks of the emulated chip.
constexpr uint64_t kPatienceTicks = 20000;

// Runs again on a fresh chip when this process was kept from running for so long that the drive gave up on it.
constexpr int kAttempts = 5;
constexpr char kHostTooSlow[] = "host_too_slow";

std::string hexadecimal(uint16_t value) { return fmt::format("{:04X}h", value); }

sim::Refusal cannot(const std::string& what, const std::string& value, const std::string& why,
                    const std::string& result) {
  return sim::Refusal(sim::Refusal::Cause::kCannot, what, value, why, result);
}

// The firmware's set-up and its handshakes, from a client's side.
class Client {
 public:
  explicit Client(sim::Session& session) : session_(session) {}

  void enable() {
    for (const uint16_t word : {kShutdown, kSwitchOn, kEnableOperation}) write(Register::kControlword, word);
    wait("operation enabled", [this] { return (status() & kStateMask) == kOperationEnabled; });
  }

  void set_shaper(const std::vector<ModeRegisters>& modes) {
    write(Register::kModeCount, static_cast<uint16_t>(modes.size()));
    for (uint32_t k = 0; k < modes.size(); ++k) {
      const ModeRegisters& mode = modes[k];
      session_.write(address_of(firmware::mode_register(k, firmware::ModeField::kFrequency)),
                     {static_cast<uint16_t>(mode.frequency >> 16), static_cast<uint16_t>(mode.frequency), mode.damping,
                      mode.tolerance, mode.kind, mode.spacing});
    }
    write(Register::kApplyShaper, kApplyAtRest);
    wait("the shaper in force", [this] {
      const auto state = static_cast<firmware::ShaperState>(read(Register::kShaperState));
      if (state == firmware::ShaperState::kRefused) refuse_with_reason();
      return state != firmware::ShaperState::kPending;
    });
  }

  void set_move(const MoveRegisters& move) {
    raise_maximum(Register::kMaximumVelocity, move.velocity);
    raise_maximum(Register::kMaximumAcceleration, std::max(move.acceleration, move.deceleration));
    raise_maximum(Register::kMaximumJerk, move.jerk);
    write32(Register::kTargetPosition, static_cast<uint32_t>(move.target));
    write32(Register::kProfileVelocity, move.velocity);
    write32(Register::kProfileAcceleration, move.acceleration);
    write32(Register::kProfileDeceleration, move.deceleration);
    write32(Register::kProfileJerk, move.jerk);
    write(Register::kProfileType, static_cast<uint16_t>(move.kind));
    write32(Register::kMoveDurationMs, move.duration_ms);
    write(Register::kZeroDelay, move.zero_delay);
  }

  MoveReport start() {
    write(Register::kControlword, kEnableOperation | firmware::kControlNewSetPoint);
    wait("the set-point taken", [this] {
      if (read(Register::kRefusalReason) != 0) refuse_with_reason();
      return (status() & firmware::kStatusSetPointTaken) != 0;
    });
    write(Register::kControlword, kEnableOperation);
    MoveReport report{};
    report.profile_ticks = session_.read32(address_of(Register::kMoveProfileTicks));
    report.total_ticks = session_.read32(address_of(Register::kMoveTotalTicks));
    report.zero_delay_met = read(Register::kMoveZeroDelayMet) != 0;
    return report;
  }

  void finish() {
    wait("the target reached", [this] { return (status() & firmware::kStatusTargetReached) != 0; });
  }

 private:
  uint16_t read(Register name) { return session_.read(address_of(name), 1)[0]; }
  uint16_t status() { return read(Register::kStatusword); }
  void write(Register name, uint16_t value) { session_.write(address_of(name), value); }
  void write32(Register name, uint32_t value) { session_.write32(address_of(name), value); }

  // The axis's own limits are the delivered ones; a simulated arm stands more.
  void raise_maximum(Register name, uint32_t wanted) {
    if (session_.read32(address_of(name)) >= wanted) return;
    write(Register::kCommandKey, static_cast<uint16_t>(firmware::CommandKey::kUnlock));
    write32(name, wanted);
  }

  template <typename Condition>
  void wait(const char* what, const Condition& condition) {
    const uint64_t begun = session_.ticks();
    while (!condition()) {
      const uint16_t fault = read(Register::kErrorCode);
      if (fault != 0) refuse_fault(fault);
      if (session_.ticks() - begun > kPatienceTicks) {
        throw cannot("drive", what, "not reached in time, a firmware that gets there is accepted", "drive_stalled");
      }
    }
  }

  [[noreturn]] static void refuse_fault(uint16_t fault) {
    if (fault == static_cast<uint16_t>(firmware::FaultCode::kLinkSilent)) {
      throw cannot("host", "too slow", "the drive heard nothing for 100 ms, a machine with less to do is accepted",
                   kHostTooSlow);
    }
    throw cannot("drive", "fault " + hexadecimal(fault), "a move without a fault is accepted", "drive_fault");
  }

  [[noreturn]] void refuse_with_reason() {
    const std::vector<uint16_t> refusal = session_.read(address_of(Register::kRefusalReason), 2);
    const uint32_t accepted = session_.read32(address_of(Register::kRefusalAccepted));
    const bool by_the_core = (refusal[0] & 0x8000U) == 0;
    const std::string why =
        by_the_core ? text(static_cast<Error>(refusal[0] >> 8)) : "reason " + hexadecimal(refusal[0]);
    const std::string what = by_the_core ? text(static_cast<Quantity>(refusal[0] & 0xFF)) : "drive";
    throw cannot(what, "register " + hexadecimal(refusal[1]),
                 why + (accepted != 0 ? ", the drive would have accepted " + std::to_string(accepted) + " there"
                                      : ", the drive names nothing that it would have accepted"),
                 "drive_refused");
  }

  sim::Session& session_;
};

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
  Client client(session);
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
  for (int attempt = 1;; ++attempt) {
    try {
      return run_once(elf, task, specs, arm, progress);
    } catch (const sim::Refusal& refusal) {
      if (refusal.result() != kHostTooSlow || attempt == kAttempts) throw;
    }
  }
}

}  // namespace stillpoint::cli
