// SPDX-License-Identifier: Apache-2.0
// A full client line of the emulated chip during a shaped move: the setpoints are the same bits, in the test image and
// in the production image.
#include <memory>
#include <string>
#include <vector>

#include "firmware/registers.hpp"
#include "sim/hash.hpp"
#include "sim/hil/lock.hpp"
#include "sim/hil/session.hpp"
#include "sim/simulated_drive.hpp"
#include "tests/firmware/flood.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

struct Flown {
  uint64_t hash = 0;
  int64_t last = 0;
  uint32_t missing = 0;
  size_t answered = 0;  // bytes, during the flood
};

// Li's move with ZV for his arm.
Flown fly(const std::string& elf, Flood* flood) {
  const std::unique_ptr<sim::Lock> lock = sim::start_locked(elf);
  sim::SimulatedDriveConfig config;
  config.modes = {{{11.0, 0.11}, 1.0}};
  sim::SimulatedDrive arm(config);
  std::vector<Signal> setpoints;
  sim::Session session(*lock, arm, [&](const hal::ServoCommand& command) { setpoints.push_back(command.setpoint); });
  for (const uint16_t word : {uint16_t{0x06}, uint16_t{0x07}, uint16_t{0x0F}}) session.write(0x0040, word);
  for (int i = 0; i < 500 && (session.read(0x0041, 1)[0] & 0x6F) != 0x27; ++i) session.tick();
  session.write(0x0102, {110000 >> 16, 110000 & 0xFFFF, 11000, 0, 1});
  session.write(0x0100, uint16_t{1});
  session.write(0x0130, uint16_t{1});
  for (int i = 0; i < 500 && session.read(0x0131, 1)[0] != 1; ++i) session.tick();
  session.write32(0x0044, 1700000);
  session.write(0x0040, uint16_t{0x1F});
  Flown flown;
  const auto drain = [&] {
    for (uint8_t byte = 0; lock->client().read(byte);) ++flown.answered;
  };
  constexpr int kTicks = 2000;
  constexpr int kQuiet = 300;  // until the last answer is out
  for (int i = 0; i < kTicks; ++i) {
    if (flood != nullptr && i < kTicks - kQuiet) {
      for (const uint8_t byte : flood->next()) lock->client().write(byte);
    }
    session.tick();
    drain();
  }
  flown.hash = sim::setpoint_hash(setpoints);
  flown.last = setpoints.back();
  flown.missing = session.read32(firmware::address_of(firmware::Register::kServoMissing));
  return flown;
}

void check(const Flown& undisturbed, const std::string& elf) {
  TEST_INFO("image", elf);
  Flood flood(1);
  const Flown flooded = fly(elf, &flood);
  TEST_ASSERT_EQUAL_UINT64(undisturbed.hash, flooded.hash);
  TEST_ASSERT_EQUAL_UINT32(0, flooded.missing);
  TEST_ASSERT_AT_LEAST_INT64(200, flooded.answered);
  MESSAGE(flood.frames(), " frames, ", flooded.answered, " bytes of answers, hash ", flooded.hash);
}

}  // namespace

// Undisturbed, the two images' moves are the same bits (test_lock.cpp); once is enough.
TEST(a_full_line_leaves_a_shaped_move_of_the_chip_as_it_is) {
  const std::string campaign = STILLPOINT_CHIP_TREE "/stillpoint_campaign.elf";
  const Flown undisturbed = fly(campaign, nullptr);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), undisturbed.last);
  check(undisturbed, campaign);
  check(undisturbed, STILLPOINT_CHIP_TREE "/stillpoint.elf");
}
