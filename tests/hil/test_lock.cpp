// SPDX-License-Identifier: Apache-2.0
// The lock itself: production image and test image under it, on machines that keep up and on those that do not.
// Needs the images of the stm32f405 preset (toolchain/test builds it first) and the emulator.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "firmware/registers.hpp"
#include "sim/hash.hpp"
#include "sim/hil/lock.hpp"
#include "sim/hil/session.hpp"
#include "sim/refusal.hpp"
#include "sim/simulated_drive.hpp"
#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

namespace {

using namespace stillpoint;
using firmware::address_of;
using firmware::Register;

const std::string kProduction = STILLPOINT_CHIP_TREE "/stillpoint.elf";
const std::string kCampaign = STILLPOINT_CHIP_TREE "/stillpoint_campaign.elf";

constexpr uint16_t kZv = 1;
constexpr uint16_t kStateMask = 0x6F;
constexpr uint16_t kOperationEnabled = 0x27;

// What one run of the paper's move, shaped for 11 Hz, gave.
struct Run {
  uint64_t hash = 0;
  int64_t last_setpoint = 0;
  uint32_t missing = 0;
  uint64_t ticks = 0;
  uint32_t least_instructions = UINT32_MAX;
  uint32_t most_instructions = 0;
  uint32_t late_ticks = 0;
};

class Chip {
 public:
  Chip(const std::string& elf, sim::Pace pace, uint32_t pause_us)
      : lock_(sim::start_locked(elf, pace)),
        drive_(arm()),
        session_(*lock_, drive_, [this](const auto& command) { note(command); }),
        pause_us_(pause_us) {}

  Run move() {
    constexpr uint16_t kEnabling[] = {0x06, 0x07, 0x0F};
    for (const uint16_t word : kEnabling) write(Register::kControlword, word);
    wait([this] { return (read(Register::kStatusword) & kStateMask) == kOperationEnabled; });
    write(Register::kModeCount, 1);
    session_.write(address_of(Register::kFirstMode), {110000 >> 16, 110000 & 0xFFFF, 11000, 0, kZv});
    write(Register::kApplyShaper, 1);
    wait([this] { return read(Register::kShaperState) == 1; });
    write32(Register::kProfileVelocity, 1200000);
    write32(Register::kProfileAcceleration, 20000000);
    write32(Register::kProfileDeceleration, 20000000);
    write32(Register::kProfileJerk, 600000);
    write32(Register::kTargetPosition, 1700000);
    write(Register::kControlword, 0x1F);
    for (int i = 0; i < 2000; ++i) session_.tick();
    run_.hash = sim::setpoint_hash(setpoints_);
    run_.last_setpoint = setpoints_.back();
    run_.missing = session_.read32(address_of(Register::kServoMissing));
    run_.ticks = session_.ticks();
    return run_;
  }

 private:
  static sim::SimulatedDriveConfig arm() {
    sim::SimulatedDriveConfig config;
    config.modes = {{{11.0, 0.11}, 1.0}};
    return config;
  }

  void note(const hal::ServoCommand& command) {
    setpoints_.push_back(command.setpoint);
    if (const auto cost = lock_->cost()) {
      run_.least_instructions = std::min(run_.least_instructions, cost->instructions);
      run_.most_instructions = std::max(run_.most_instructions, cost->instructions);
      run_.late_ticks = cost->late_ticks;
    }
    if (pause_us_ != 0 && random_.next() % 8 == 0) {
      std::this_thread::sleep_for(std::chrono::microseconds(random_.integer(0, pause_us_)));
    }
  }

  uint16_t read(Register name) { return session_.read(address_of(name), 1)[0]; }
  void write(Register name, uint16_t value) { session_.write(address_of(name), value); }
  void write32(Register name, uint32_t value) { session_.write32(address_of(name), value); }

  template <typename Condition>
  void wait(const Condition& condition) {
    for (int i = 0; i < 500; ++i) {
      if (condition()) return;
    }
    TEST_ASSERT_TRUE(false);
  }

  std::unique_ptr<sim::Lock> lock_;
  sim::SimulatedDrive drive_;
  sim::Session session_;
  uint32_t pause_us_;
  testing::Random random_{7};
  std::vector<Signal> setpoints_;
  Run run_;
};

Run run(const std::string& elf, sim::Pace pace = sim::Pace::kLock, uint32_t pause_us = 0) {
  return Chip(elf, pace, pause_us).move();
}

// The word for why it was refused, or "" when it was not.
std::string refusal_of(const std::string& elf) {
  try {
    sim::start_locked(elf)->exchange({});
  } catch (const sim::Refusal& refusal) {
    return refusal.result();
  }
  return "";
}

}  // namespace

TEST(the_production_image_moves_in_step_and_misses_no_tick) {
  const Run production = run(kProduction);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), production.last_setpoint);
  TEST_ASSERT_EQUAL_UINT32(0, production.missing);
}

TEST(the_setpoints_are_the_same_bits_at_any_speed_of_the_host_and_over_either_transport) {
  const Run campaign = run(kCampaign);
  const Run production = run(kProduction);
  const Run hindered = run(kProduction, sim::Pace::kLock, 3000);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), campaign.last_setpoint);
  TEST_ASSERT_EQUAL_UINT64(campaign.hash, production.hash);
  TEST_ASSERT_EQUAL_UINT64(campaign.hash, hindered.hash);
}

TEST(the_test_image_repeats_itself_to_the_tick_and_to_the_instruction) {
  const Run once = run(kCampaign);
  const Run again = run(kCampaign, sim::Pace::kLock, 1000);
  TEST_ASSERT_EQUAL_UINT64(once.ticks, again.ticks);
  TEST_ASSERT_EQUAL_UINT32(once.least_instructions, again.least_instructions);
  TEST_ASSERT_EQUAL_UINT32(once.most_instructions, again.most_instructions);
  // A millisecond at 168 MHz is 168,000 cycles.
  TEST_ASSERT_TRUE(once.most_instructions < 10000);
}

TEST(no_tick_is_late_with_a_free_running_systick) {
  const Run free = run(kCampaign, sim::Pace::kFreeSysTick);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), free.last_setpoint);
  TEST_ASSERT_EQUAL_UINT32(0, free.late_ticks);
  TEST_ASSERT_EQUAL_UINT32(0, free.missing);
}

TEST(an_image_that_is_none_is_refused_by_name) {
  TEST_ASSERT_TRUE(refusal_of("/nonexistent/stillpoint.elf") == "bad_argument");
  TEST_ASSERT_TRUE(refusal_of("/proc/self/cmdline") == "bad_argument");
}

TEST(an_emulator_that_ends_is_told_from_one_that_is_silent) {
  // The host's own program is an ELF file, but not one for this chip.
  TEST_ASSERT_TRUE(refusal_of(std::filesystem::canonical("/proc/self/exe")) == "emulator_ended");
}
