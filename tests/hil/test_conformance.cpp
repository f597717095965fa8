// SPDX-License-Identifier: Apache-2.0
// The conformance table of tests/firmware against the emulated chip: the test image, which hears every byte in its tick
// on any host, and the production image, unchanged, over its serial line.
#include <memory>
#include <string>

#include "sim/hil/lock.hpp"
#include "sim/simulated_drive.hpp"
#include "tests/firmware/modbus_conformance.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

const std::string kProduction = STILLPOINT_CHIP_TREE "/stillpoint.elf";
const std::string kLean = STILLPOINT_CHIP_TREE "/stillpoint-lean.elf";
const std::string kCampaign = STILLPOINT_CHIP_TREE "/stillpoint_campaign.elf";

// How often a request, or a group, may be asked again.
struct Patience {
  int requests;
  int groups;
};

class Chip {
 public:
  explicit Chip(const std::string& elf) : lock_(sim::start_locked(elf)) {}

  // What comes for the frame: until as much has come as is expected, or for as long as an answer takes.
  Bytes ask(const Bytes& frame, size_t expected) {
    Bytes got;
    for (const uint8_t byte : frame) lock_->client().write(byte);
    for (uint32_t i = 0; i < kAnswerTicks && (expected == 0 || got.size() < expected); ++i) {
      tick();
      take(got);
    }
    for (uint32_t i = 0; i < kBetweenFrames; ++i) tick();
    take(got);  // nothing may follow
    return got;
  }

  // The output stage was asked for.
  bool ever_enabled() const { return ever_enabled_; }

 private:
  static constexpr uint32_t kAnswerTicks = 40;
  static constexpr uint32_t kBetweenFrames = 6;

  void tick() {
    command_ = lock_->exchange(arm_.exchange(command_));
    ever_enabled_ = ever_enabled_ || command_.enabled;
  }
  void take(Bytes& got) {
    uint8_t byte = 0;
    while (lock_->client().read(byte)) got.push_back(byte);
  }

  std::unique_ptr<sim::Lock> lock_;
  sim::SimulatedDrive arm_{sim::SimulatedDriveConfig{}};
  hal::ServoCommand command_ = {};
  bool ever_enabled_ = false;
};

// The first row that is not answered as it should be, or as many as there are. Only silence is asked again.
size_t first_wrong(Chip& chip, const ConformanceGroup& group, int requests, int& repeated) {
  for (size_t i = 0; i < group.rows.size(); ++i) {
    const Bytes expected = group.rows[i].answer.empty() ? Bytes{} : framed(group.rows[i].answer);
    Bytes got = chip.ask(group.rows[i].frame, expected.size());
    for (int k = 1; k < requests && got.empty() && !expected.empty(); ++k, ++repeated) {
      got = chip.ask(group.rows[i].frame, expected.size());
    }
    if (got != expected) return i;
  }
  return group.rows.size();
}

void check(const std::string& elf, const Patience& patience) {
  const ConformanceTable table;
  auto chip = std::make_unique<Chip>(elf);
  int repeated = 0;
  for (const ConformanceGroup& group : table.groups()) {
    TEST_INFO("group", group.name);
    size_t wrong = first_wrong(*chip, group, patience.requests, repeated);
    for (int attempt = 1; attempt < patience.groups && wrong != group.rows.size(); ++attempt, ++repeated) {
      chip = std::make_unique<Chip>(elf);
      wrong = first_wrong(*chip, group, patience.requests, repeated);
    }
    TEST_INFO("first wrong row", wrong);
    TEST_ASSERT_EQUAL_UINT64(group.rows.size(), wrong);
    TEST_ASSERT_FALSE(chip->ever_enabled());
  }
  MESSAGE(table.groups().size(), " groups, asked again ", repeated, " times");
}

}  // namespace

TEST(every_row_of_the_conformance_table_is_answered_byte_for_byte_by_the_chip) { check(kCampaign, {1, 1}); }

// The emulator hands the bytes over one by one while the firmware's own millisecond runs on: on a host that does not
// keep up it sees silence inside a frame and drops it, as on a bad line (see sim::Session). So a request without an
// answer is sent again, and a group in which one that must not be answered was lost is asked again on a fresh chip.
TEST(the_production_image_answers_the_same_over_its_serial_line) { check(kProduction, {20, 5}); }
TEST(so_does_the_lean_one) { check(kLean, {20, 5}); }
