// SPDX-License-Identifier: Apache-2.0
// The chip follows its arm from move to move: no tick is late for it, and no client waits.
#include <memory>
#include <string>

#include "firmware/registers.hpp"
#include "sim/hil/lock.hpp"
#include "sim/hil/session.hpp"
#include "sim/simulated_drive.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kArmHz = 10.93;
constexpr uint32_t kUsed = 0x0252;
constexpr uint32_t kRecorded = 2150;  // ticks from a move's beginning to the end of its record: 1.1 s and 1.03 s

// The test image, whose millisecond runs on; the shaper is made for 11 Hz and 0.04.
struct Chip {
  std::unique_ptr<sim::Lock> lock =
      sim::start_locked(STILLPOINT_CHIP_TREE "/stillpoint_campaign.elf", sim::Pace::kFreeSysTick);
  sim::SimulatedDrive arm{config()};
  sim::Session session{*lock, arm,
                       [this](const hal::ServoCommand& command) { moves = command.setpoint != last(command); }};
  int64_t before = 0;
  bool moves = false;

  static sim::SimulatedDriveConfig config() {
    sim::SimulatedDriveConfig config;
    config.modes = {{{kArmHz, 0.04}, 1.0}};
    config.accelerometer = {0.02, 1e6, 0.05, 1};
    return config;
  }
  int64_t last(const hal::ServoCommand& command) {
    const int64_t was = before;
    before = command.setpoint;
    return was;
  }
  uint32_t get(uint16_t address) { return session.read(address, 1)[0]; }
  void set(uint16_t address, uint16_t value) { session.write(address, value); }
  void tick(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; ++i) session.tick();
  }
  void set_up() {
    for (const uint16_t word : {uint16_t{0x06}, uint16_t{0x07}, uint16_t{0x0F}}) set(0x0040, word);
    session.write(0x0100, {1, 0, 110000 >> 16, 110000 & 0xFFFF, 4000, 0, 1});
    set(0x0130, 1);
    tick(50);
    TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
    TEST_ASSERT_EQUAL_UINT32(0x27, get(0x0041) & 0x6F);
    set(0x0250, 1);
  }
  // Ticks from the request to the first that moves.
  uint32_t start(int32_t target) {
    session.write32(0x0044, static_cast<uint32_t>(target));
    set(0x0040, 0x0F);
    set(0x0040, 0x1F);
    uint32_t ticks = 0;
    for (; ticks < 5000 && !moves; ++ticks) session.tick();
    return ticks;
  }
  uint32_t heard() { return session.read32(kUsed) + session.read32(0x0254); }
  // Ticks until so many records were.
  uint32_t wait_for_heard(uint32_t count) {
    const uint64_t begun = session.ticks();
    while (heard() < count && session.ticks() - begun < 60000) tick(20);
    return static_cast<uint32_t>(session.ticks() - begun);
  }
};

}  // namespace

TEST(the_chip_follows_its_arm_without_a_tick_too_late) {
  Chip chip;
  chip.set_up();
  chip.start(1000000);
  chip.tick(kRecorded);
  const uint32_t look = chip.wait_for_heard(1);
  // The next record is being looked at when a set-point comes.
  chip.start(0);
  chip.tick(kRecorded + 100);
  TEST_ASSERT_EQUAL_UINT32(1, chip.heard());
  const uint32_t waited = chip.start(1000000);
  const uint32_t again = chip.wait_for_heard(2);
  chip.start(0);
  chip.wait_for_heard(3);
  chip.start(1000000);
  chip.wait_for_heard(4);
  const double tracked = 1e-4 * chip.session.read32(0x0260);
  MESSAGE("a look of ", look, " ms, a set-point in it waited ", waited, " ms, looked at ", again, " ms later, ",
          tracked, " Hz");
  TEST_ASSERT_AT_LEAST_INT64(200, look);
  TEST_ASSERT_AT_MOST_INT64(100, waited);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, kArmHz, tracked);
  TEST_ASSERT_EQUAL_INT64(int64_t{1000000} << 32, chip.before);
  TEST_ASSERT_EQUAL_UINT32(0, chip.get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0, chip.session.read32(0x001A));
  TEST_ASSERT_EQUAL_UINT32(0, chip.lock->cost()->late_ticks);
}
