// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/host_tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "firmware/axis_limits.hpp"
#include "firmware/default_axis.hpp"
#include "firmware/parameters.hpp"
#include "firmware/register_units.hpp"
#include "firmware/set_point.hpp"
#include "firmware/state_machine.hpp"
#include "shaper/axis/axis.hpp"
#include "sim/cli/chip_client.hpp"
#include "sim/cli/drive_registers.hpp"
#include "sim/cli/drive_scope.hpp"
#include "sim/cli/drive_state.hpp"
#include "sim/cli/rest_recorder.hpp"
#include "sim/cli/shaper_in_force.hpp"
#include "sim/cli/tune_output.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Register;

// Registers that are changed for a while.
class Borrowed {
 public:
  explicit Borrowed(sim::RegisterPort& port) : port_(port) {}
  void note(Register name) {
    const firmware::Parameter parameter = firmware::kParameters[firmware::find_parameter(address_of(name))];
    before_.emplace_back(parameter, read_parameter(port_, parameter));
  }
  void set(Register name, int64_t value) {
    note(name);
    if (before_.back().second != value) write_parameter(port_, before_.back().first, value);
  }
  void put_back() {
    for (; !before_.empty(); before_.pop_back()) write_parameter(port_, before_.back().first, before_.back().second);
  }

 private:
  sim::RegisterPort& port_;
  std::vector<std::pair<firmware::Parameter, int64_t>> before_;
};

AxisConfig axis_of(ChipClient& client) {
  AxisConfig config = firmware::kDefaultAxis;
  firmware::take_axis_limits([&](Register name) { return client.read32(name); }, config);
  return config;
}

// By the drive's own reading of its registers.
Move move_by(ChipClient& client) {
  firmware::Parameters parameters;
  parameters.load_defaults();
  for (const Register name : {Register::kProfileVelocity, Register::kProfileAcceleration,
                              Register::kProfileDeceleration, Register::kProfileJerk})
    parameters.set(name, client.read32(name));
  parameters.set_signed(Register::kProfileType, static_cast<int16_t>(client.read(Register::kProfileType)));
  parameters.set(Register::kZeroDelay, client.read(Register::kZeroDelay));
  Move move{};
  sim::require(firmware::make_move(parameters, false, 0, move));
  return move;
}

TuneConfig config_of(const TuneRegisters& registers, const Move& move) {
  check_host_can(registers);
  TuneConfig config{};
  config.excitation = TuneExcitation::kMove;
  config.source = static_cast<TuneSource>(registers.source);
  config.move = move;
  config.amplitude_counts = registers.amplitude;
  config.travel_counts = registers.travel;
  config.low_hz = registers.band_low / firmware::kBandPerHz;
  config.high_hz = registers.band_high / firmware::kBandPerHz;
  config.tolerance = registers.tolerance / firmware::kResidualPerOne;
  config.sensor_lowest = registers.sensor_lowest;
  config.sensor_highest = registers.sensor_highest;
  config.samples = sim::samples_for_tuning(TuneMemory::kSamples);
  return config;
}

class HostTuner {
 public:
  HostTuner(sim::RegisterPort& port, const HostTuneTask& task)
      : task_(task),
        client_(port),
        recorder_(port, [this] { watch(); }),
        config_(config_of(task.registers, move_by(client_))) {
    sim::require(rig_->axis.configure(axis_of(client_)));
    rig_->tune.begin(rig_->axis, rig_->memory);
    home_ = static_cast<int32_t>(client_.read32(Register::kDemandAfterShaping));
    rig_->axis.reset(signal_from_counts(home_));
  }

  // Nothing has moved after a refusal.
  void start() {
    Status status = start_towards(1);
    // As the drive: downwards where there is no room above.
    if (!status.ok() && status.quantity == Quantity::kPosition && start_towards(-1).ok()) status = kOk;
    sim::require(status);
    recorder_.prepare(config_, home_);
  }

  TuneReport run(ShaperInForce& shaper) {
    task_.announced(rig_->tune.report().announced);
    wait_ms(client_.read(Register::kTuneLeadMs));
    shaper.replace({});
    if (static_cast<int32_t>(client_.read32(Register::kDemandAfterShaping)) != home_) {
      throw sim::Refusal(sim::Refusal::Cause::kCannot, "axis", "moves", "somebody else has it, one at rest is accepted",
                         "drive_refused");
    }
    const TuneReport& report = rig_->tune.report();
    while (rig_->tune.busy()) {
      show_progress();
      tick();
      rig_->axis.service();
      rig_->tune.service({});
      if (report.state != TuneState::kProposed) continue;
      if (task_.propose) break;
      shaper.replace(registers_of(proposed_shapers(report.proposal)));
      sim::require(rig_->tune.accept());
    }
    if (!report.refusal.ok()) sim::require(report.refusal);
    TuneReport ended = report;
    ended.flaws.gaps = gaps_;
    Identification& found = ended.identification;
    const double strongest = found.mode[0].amplitude;
    for (size_t k = 0; k < found.mode_count; ++k) found.mode[k].amplitude /= strongest;
    return ended;
  }

 private:
  struct Rig {
    Axis<firmware::kLineCapacity> axis;
    AutoTune tune;
    TuneMemory memory;
  };

  Status start_towards(int32_t way) {
    const int64_t target = int64_t{home_} + way * int64_t{task_.registers.amplitude};
    if (target > kMaxPositionCounts || target < kMinPositionCounts) {
      const double room = way > 0 ? double{kMaxPositionCounts} - home_ : home_ - double{kMinPositionCounts};
      return refuse(Error::kAboveMaximum, Quantity::kPosition, task_.registers.amplitude, room);
    }
    config_.move.target_counts = static_cast<int32_t>(target);
    return rig_->tune.start(config_, nullptr);
  }

  void show_progress() const { task_.meanwhile(rig_->tune.report().progress_percent / 100.0); }

  // Asks the drive: only where it is the drive that is waited for.
  void watch() {
    show_progress();
    client_.refuse_any_fault();
  }

  uint32_t uptime_ms() { return client_.read32(Register::kUptimeMs); }
  uint32_t drive_ticks() { return client_.read32(Register::kServoTicks); }

  void wait_ms(uint32_t ms) {
    for (const uint32_t begun = uptime_ms(); uptime_ms() - begun < ms;) watch();
  }

  // The rest has been recorded when it is told here; after it this axis's time is the drive's. While this axis moves
  // the tuner looks at nothing but whether there is an accelerometer.
  void tick() {
    const Signal setpoint = rig_->axis.tick();
    const bool moves = rig_->axis.state().phase != AxisPhase::kAtRest;
    if (moves && !moves_) take_record();
    if (moves != moves_) told_ = 0;
    moves_ = moves;
    rig_->tune.tick(rest_.at(told_, setpoint));
    ++told_;
    const auto recorded = static_cast<uint32_t>(rest_.ticks());
    if (!moves && told_ > recorded) wait_after_record(told_ - recorded);
  }

  void take_record() {
    rest_ = recorder_.move_and_record();
    if (rig_->tune.report().state != TuneState::kVerifying) gaps_ = recorder_.gaps();
    recorded_at_ = seen_at_ = drive_ticks();
  }

  void wait_after_record(uint32_t ticks) {
    while (seen_at_ - recorded_at_ < ticks) {
      watch();
      seen_at_ = drive_ticks();
    }
  }

  const HostTuneTask& task_;
  ChipClient client_;
  RestRecorder recorder_;
  TuneConfig config_;
  std::unique_ptr<Rig> rig_ = std::make_unique<Rig>();
  int32_t home_ = 0;
  sim::RecordedRest rest_;
  bool moves_ = false;
  uint32_t told_ = 0;  // ticks of the motion, or of the rest
  uint32_t gaps_ = 0;
  uint32_t recorded_at_ = 0;  // of the drive's ticks
  uint32_t seen_at_ = 0;
};

// Whatever can be: the drive may be silent, or in a fault.
void put_everything_back(sim::RegisterPort& port, ShaperInForce& shaper, Borrowed& borrowed) {
  ChipClient client(port);
  try {
    const bool halted = client.is_enabled();
    if (halted) client.write(Register::kControlword, kEnableOperation | firmware::kControlHalt);
    shaper.put_back();
    if (halted && client.is_enabled()) client.write(Register::kControlword, kEnableOperation);
    borrowed.put_back();
    stop_scope(port);
  } catch (const sim::Refusal& refusal) {
    fmt::print(stderr, "stillpoint: error: {}\n", refusal.what());
  }
}

}  // namespace

void check_host_can(const TuneRegisters& registers) {
  const auto excitation = static_cast<TuneExcitation>(registers.excitation);
  if (excitation == TuneExcitation::kAuto || excitation == TuneExcitation::kMove) return;
  throw sim::bad_argument("--excitation", sim::text(excitation),
                          "not to be had by set-points from the host, auto and move are accepted");
}

HostTuning tune_by_host(sim::RegisterPort& port, const HostTuneTask& task) {
  HostTuner tuner(port, task);
  tuner.start();
  ShaperInForce shaper(port);
  Borrowed borrowed(port);
  ChipClient client(port);
  borrowed.note(Register::kMode);
  client.take_profile_position_mode();
  HostTuning tuning{};
  try {
    borrowed.set(Register::kMoveDurationMs, 0);
    tuning.report = tuner.run(shaper);
    if (tuning.report.state != TuneState::kKept) shaper.put_back();
    borrowed.put_back();
    stop_scope(port);
  } catch (const sim::Refusal&) {
    put_everything_back(port, shaper, borrowed);
    throw;
  }
  if (tuning.report.state != TuneState::kKept) return tuning;
  shaper.keep();
  tuning.shapers = proposed_shapers(tuning.report.proposal);
  return tuning;
}

}  // namespace stillpoint::cli
