// SPDX-License-Identifier: Apache-2.0
// The host tunes the chip: what the image's scope records in the emulator is enough to leave its arm still.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "sim/cli/chip_client.hpp"
#include "sim/cli/host_tune.hpp"
#include "sim/cli/tune_client.hpp"
#include "sim/hil/lock.hpp"
#include "sim/hil/session.hpp"
#include "sim/simulated_drive.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kArmHz = 13.37;
constexpr double kArmDamping = 0.083;

struct Chip {
  std::unique_ptr<sim::Lock> lock = sim::start_locked(STILLPOINT_CHIP_TREE "/stillpoint_campaign.elf");
  sim::SimulatedDrive arm{config()};
  double largest = 0.0;  // deflection since the setpoint last changed
  int64_t before = 0;
  sim::Session session{*lock, arm, [this](const hal::ServoCommand& command) {
                         if (command.setpoint != before) largest = 0.0;
                         before = command.setpoint;
                         largest = std::fmax(largest, std::fabs(arm.arm().deflection()));
                       }};

  static sim::SimulatedDriveConfig config() {
    sim::SimulatedDriveConfig config;
    config.modes = {{{kArmHz, kArmDamping}, 1.0}};
    config.accelerometer = {0.02, 1e6, 0.05, 1};
    return config;
  }
  double ringing_after_move(cli::ChipClient& client, int32_t target) {
    client.write32(firmware::Register::kTargetPosition, static_cast<uint32_t>(target));
    client.finish(client.start().total_ticks);
    for (int i = 0; i < 300; ++i) session.tick();
    return largest;
  }
};

TEST(the_chips_arm_is_left_still_by_the_hosts_tuning) {
  Chip chip;
  cli::ChipClient client(chip.session);
  client.enable();
  const double plain = chip.ringing_after_move(client, 200000);
  cli::TuneRegisters registers = cli::TuneClient(chip.session).registers();
  registers.band_low = 50;
  const cli::HostTuning tuning =
      cli::tune_by_host(chip.session, {registers, false, [](const Announcement&) {}, [](double) {}});
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, tuning.report.state);
  const IdentifiedMode& mode = tuning.report.identification.mode[0];
  TEST_ASSERT_DOUBLE_WITHIN(0.005 * kArmHz, kArmHz, mode.frequency_hz);
  TEST_ASSERT_DOUBLE_WITHIN(0.1 * kArmDamping, kArmDamping, mode.damping_ratio);
  TEST_ASSERT_EQUAL_UINT32(1, client.read(firmware::Register::kShaperState));
  const double shaped = chip.ringing_after_move(client, 0);
  std::printf("%.4f Hz, %.5f, %.3f %% left, %llu ticks\n", mode.frequency_hz, mode.damping_ratio,
              100.0 * shaped / plain, static_cast<unsigned long long>(chip.session.ticks()));
  TEST_ASSERT_AT_MOST_DOUBLE(0.05 * plain, shaped);
}

}  // namespace
