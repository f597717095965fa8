// SPDX-License-Identifier: Apache-2.0
// The host tunes a drive over its registers: the firmware in this process, an arm behind its motor.
#include "sim/cli/host_tune.hpp"

#include "firmware/registers.hpp"
#include "sim/cli/drive_tune.hpp"
#include "sim/cli/tune_client.hpp"
#include "sim/refusal.hpp"
#include "tests/firmware/tune_rig.hpp"
#include "tests/sim/refusals.hpp"
#include "tests/sim/rig_port.hpp"
#include "tests/support/random.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kShaperWords = 34;  // from 0100 on
constexpr uint32_t kPlainTarget = 1000000;

// As a drive without a tuner answers.
class TunerlessPort final : public RigPort {
 public:
  using RigPort::RigPort;
  using RigPort::write;
  std::vector<uint16_t> read(uint16_t address, uint16_t count) override {
    std::vector<uint16_t> words = RigPort::read(address, count);
    if (refused_ && address == 0x0012) words[0] = firmware::kReasonNotAvailable;
    if (refused_ && address + count > 0x0013 && address <= 0x0013) words[0x0013U - address] = 0x0200;
    return words;
  }
  void write(uint16_t address, const std::vector<uint16_t>& values) override {
    refused_ = address == 0x0200;
    if (refused_) throw sim::refused_register(address, 6);
    RigPort::write(address, values);
  }

 private:
  bool refused_ = false;
};

cli::TuneRegisters registers_of(sim::RegisterPort& port) {
  cli::TuneRegisters registers = cli::TuneClient(port).registers();
  registers.amplitude = 300000;
  registers.travel = 400000;
  return registers;
}

cli::HostTuneTask task_of(sim::RegisterPort& port) {
  return {registers_of(port), false, [](const Announcement&) {}, [](double) {}};
}

struct HostTuned : TuneRig {
  RigPort port{*this};

  explicit HostTuned(const sim::SimulatedDriveConfig& config = papers_arm()) : TuneRig(config) { enable(); }
  cli::HostTuning tune() { return tune_by_host(port, task_of(port)); }

  // What a tuning that keeps nothing leaves alone: the set shown and staged, what is in force, mode, duration, zero
  // delay.
  std::vector<uint32_t> settings() {
    std::vector<uint32_t> all;
    for (const uint16_t word : read(0x0100, kShaperWords)) all.push_back(word);
    for (const uint32_t address : {0x0131U, 0x0134U, 0x0135U, 0x0137U, 0x0138U, 0x0139U, 0x0042U, 0x0043U})
      all.push_back(get(address));
    return all;
  }

  // In force in set 2, while another is shown and edited.
  void shape() {
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 2));
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0102, {1, 24464, 5000, 0, 2, 0}));  // ZVD, 9 Hz
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 1));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    step(50);
    TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 5));
    TEST_ASSERT_EQUAL_UINT32(0, write(0x010A, {0, 54711, 123, 0, 1, 0}));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 2));
  }

  void check_stands() {
    step(100);
    arm.forget();
    step(300);
    TEST_ASSERT_TRUE(still());
    TEST_ASSERT_EQUAL_UINT32(0x27, state());
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0301));  // and the scope's memory is free
  }
};

SeenRefusal refusal_of_tuning(HostTuned& rig, const cli::HostTuneTask& task) {
  return refusal_of([&] { static_cast<void>(tune_by_host(rig.port, task)); });
}

void check_mode(const Identification& found, double frequency_hz, double damping) {
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, found.finding);
  TEST_ASSERT_DOUBLE_WITHIN(0.005 * frequency_hz, frequency_hz, found.mode[0].frequency_hz);
  TEST_ASSERT_DOUBLE_WITHIN(0.1 * damping, damping, found.mode[0].damping_ratio);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, found.mode[0].amplitude);
}

TEST(an_unknown_arm_is_left_still) {
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    TEST_INFO("seed", seed);
    Random random(seed);
    sim::SimulatedDriveConfig config = papers_arm();
    const double frequency_hz = random.between(3.0, 30.0);
    const double damping = random.between(0.02, 0.12);
    config.modes = {{{frequency_hz, damping}, 1.0}};
    config.accelerometer.seed = seed;
    config.encoder.noise_counts = 1.0;
    HostTuned rig(config);
    const double plain = rig.ringing_after_move(kPlainTarget);
    rig.step(5000);
    const cli::HostTuning tuning = rig.tune();
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, tuning.report.state);
    TEST_ASSERT_EQUAL_ENUM(TuneSource::kAccelerometer, tuning.report.source);
    check_mode(tuning.report.identification, frequency_hz, damping);
    TEST_ASSERT_EQUAL_INT64(kPlainTarget, rig.demand());  // back where it began
    TEST_ASSERT_EQUAL_UINT32(tuning.shapers.size(), rig.get(0x0100));
    TEST_ASSERT_EQUAL_UINT32(1, rig.get(0x0131));
    rig.step(5000);
    TEST_ASSERT_AT_MOST_DOUBLE(0.05 * plain, rig.ringing_after_move(0));
    rig.check_stands();
  }
}

TEST(a_motor_that_the_arm_shakes_tells_where_there_is_no_accelerometer) {
  sim::SimulatedDriveConfig config = papers_arm();
  config.accelerometer.resolution = 1e9;
  config.reaction = 0.05;
  for (const TuneSource source : {TuneSource::kAuto, TuneSource::kFollowingError}) {
    HostTuned rig(config);
    const double plain = rig.ringing_after_move(kPlainTarget);
    cli::HostTuneTask task = task_of(rig.port);
    task.registers.source = static_cast<uint16_t>(source);
    const cli::HostTuning tuning = tune_by_host(rig.port, task);
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, tuning.report.state);
    TEST_ASSERT_EQUAL_ENUM(TuneSource::kFollowingError, tuning.report.source);
    check_mode(tuning.report.identification, 11.0, 0.11);
    rig.step(2000);
    TEST_ASSERT_AT_MOST_DOUBLE(0.05 * plain, rig.ringing_after_move(0));
  }
}

TEST(two_modes_get_a_shaper_each) {
  sim::SimulatedDriveConfig config = papers_arm();
  config.modes = {{{11.0, 0.05}, 0.9}, {{29.0, 0.02}, 0.1}};
  HostTuned rig(config);
  TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0068, 6000000));
  const cli::HostTuning tuning = rig.tune();
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, tuning.report.state);
  TEST_ASSERT_EQUAL_UINT64(2, tuning.report.identification.mode_count);
  TEST_ASSERT_DOUBLE_WITHIN(0.005 * 29.0, 29.0, tuning.report.identification.mode[1].frequency_hz);
  TEST_ASSERT_EQUAL_UINT64(2, tuning.shapers.size());
}

TEST(what_was_in_force_is_in_force_again_wherever_it_is_interrupted) {
  for (uint64_t seed = 1; seed <= 25; ++seed) {
    TEST_INFO("seed", seed);
    Random random(seed);
    HostTuned rig;
    rig.shape();
    const std::vector<uint32_t> before = rig.settings();
    cli::HostTuneTask task = task_of(rig.port);
    // It is called about once a tick of what is told and once a request of what is waited for.
    auto left = random.integer(0, 8000);
    task.meanwhile = [&](double) {
      if (left-- == 0) throw sim::bad_argument("test", "interrupted", "");
    };
    TEST_ASSERT_TRUE(refusal_of_tuning(rig, task).result == "bad_argument");
    TEST_ASSERT_TRUE(before == rig.settings());
    rig.check_stands();
  }
}

TEST(a_fault_on_the_way_has_the_old_set_in_force_once_it_is_reset) {
  HostTuned rig;
  rig.shape();
  const std::vector<uint32_t> before = rig.settings();
  cli::HostTuneTask task = task_of(rig.port);
  int calls = 0;
  task.meanwhile = [&](double) {
    if (++calls == 40) rig.drive.note_fault(firmware::FaultCode::kTickOverrun);
  };
  TEST_ASSERT_TRUE(refusal_of_tuning(rig, task).result == "drive_fault");
  for (const uint32_t word : {0x00U, 0x80U, 0x00U}) rig.control(word);
  rig.step(100);
  TEST_ASSERT_EQUAL_UINT32(0, rig.get(0x0010));
  TEST_ASSERT_TRUE(before == rig.settings());
}

TEST(a_proposal_and_an_arm_that_does_not_ring_keep_nothing) {
  HostTuned rig;
  rig.shape();
  const std::vector<uint32_t> before = rig.settings();
  cli::HostTuneTask task = task_of(rig.port);
  task.propose = true;
  const cli::HostTuning proposed = tune_by_host(rig.port, task);
  TEST_ASSERT_EQUAL_ENUM(TuneState::kProposed, proposed.report.state);
  TEST_ASSERT_EQUAL_UINT32(1, proposed.report.proposal.spec_count);
  TEST_ASSERT_TRUE(proposed.shapers.empty());
  TEST_ASSERT_TRUE(before == rig.settings());
  rig.check_stands();

  sim::SimulatedDriveConfig config = papers_arm();
  config.modes[0].share = 1e-9;
  HostTuned stiff(config);
  stiff.shape();
  const std::vector<uint32_t> stiff_before = stiff.settings();
  const cli::HostTuning none = stiff.tune();
  TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, none.report.state);
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoMode, none.report.identification.finding);
  TEST_ASSERT_TRUE(stiff_before == stiff.settings());
  stiff.check_stands();
}

TEST(zero_delay_is_kept_and_a_soft_limit_turns_the_move_round) {
  HostTuned rig;
  TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0137, 1));
  TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0138, 700));
  rig.unlock();
  TEST_ASSERT_EQUAL_UINT32(0, rig.write(0x0074, {0xFFF0, 0, 1, 0}));  // -1048576 to 65536
  rig.arm.forget();
  const cli::HostTuning tuning = rig.tune();
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, tuning.report.state);
  TEST_ASSERT_DOUBLE_WITHIN(1.0, 300000.0, rig.reach_from(0));
  TEST_ASSERT_EQUAL_INT64(300000, static_cast<int64_t>(tuning.report.announced.travel));
  TEST_ASSERT_TRUE(std::all_of(rig.arm.setpoints.begin(), rig.arm.setpoints.end(), [](int64_t s) { return s <= 0; }));
  TEST_ASSERT_EQUAL_UINT32(1, rig.get(0x0137));
  TEST_ASSERT_EQUAL_UINT32(700, rig.get_wide(0x0138));
}

// By what it says, with nothing moved.
template <typename Change>
void expect_refused(const std::string& what, const Change& change) {
  TEST_INFO("what", what);
  HostTuned rig;
  rig.shape();
  const std::vector<uint32_t> before = rig.settings();
  cli::HostTuneTask task = task_of(rig.port);
  change(rig, task);
  rig.arm.forget();
  const std::string said = refusal_of_tuning(rig, task).said;
  TEST_INFO("said", said);
  TEST_ASSERT_TRUE(said.find(what) == 0);
  TEST_ASSERT_TRUE(said.find("accepted") != std::string::npos);
  TEST_ASSERT_TRUE(rig.still());
  TEST_ASSERT_EQUAL_UINT32(before[32], rig.settings()[32]);
}

TEST(what_the_host_cannot_do_is_refused_by_name_and_nothing_moves) {
  using Task = cli::HostTuneTask;
  for (const TuneExcitation excitation : {TuneExcitation::kBump, TuneExcitation::kSteppedSine, TuneExcitation::kChirp})
    expect_refused("--excitation: ",
                   [&](HostTuned&, Task& task) { task.registers.excitation = static_cast<uint16_t>(excitation); });
  expect_refused("travel: ", [](HostTuned&, Task& task) { task.registers.travel = 1000; });
  expect_refused("frequency: ", [](HostTuned&, Task& task) { task.registers.band_low = 1; });
  expect_refused("tolerance: ", [](HostTuned&, Task& task) { task.registers.tolerance = 9999; });
  expect_refused("position: ", [](HostTuned&, Task& task) { task.registers.amplitude = 3000000000; });
  // Staged anew in the set that is in force: what to put back cannot be told.
  expect_refused("shaper: in force", [](HostTuned& rig, Task&) {
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0101, 2));
    TEST_ASSERT_EQUAL_UINT32(0, rig.write(0x0102, {1, 0, 5000, 0, 2, 0}));
  });
}

TEST(a_drive_without_a_tuner_is_tuned_by_the_host_unless_it_must_be_the_drive) {
  TuneRig rig;
  rig.enable();
  TunerlessPort port(rig);
  cli::DriveTuneOptions options;
  options.band = "5:200";
  cli::Output output;
  TEST_ASSERT_EQUAL_INT32(0, tune_drive(port, options, output));
  TEST_ASSERT_EQUAL_UINT32(1, rig.get(0x0131));
  TEST_ASSERT_DOUBLE_WITHIN(550, 110000, rig.get_wide(0x0102));
  options.by = "drive";
  const auto ask = [&] { static_cast<void>(tune_drive(port, options, output)); };
  TEST_ASSERT_TRUE(refusal_of(ask).result == "drive_refused");
}

}  // namespace
