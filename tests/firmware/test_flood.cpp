// SPDX-License-Identifier: Apache-2.0
// A full client line during a shaped move: the setpoints are the same bits. The emulated chip's: tests/hil.
#include <vector>

#include "sim/hash.hpp"
#include "tests/firmware/drive402.hpp"
#include "tests/firmware/flood.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

// Li's move with ZV for his arm. `flood`: on the line from the answer to the set-point on.
struct FloodedMove : Enabled402 {
  uint64_t run(Flood* flood) {
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0102, {110000 >> 16, 110000 & 0xFFFF, 11000, 0, 1}));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0100, 1));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    step(50);
    TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
    start_move(1700000);
    for (int i = 0; i < 2500; ++i) {
      if (flood != nullptr) send(flood->next());
      step();
    }
    TEST_ASSERT_EQUAL_INT64(1700000 * kCount, servo.setpoint());
    std::vector<Signal> setpoints;
    for (const hal::ServoCommand& command : servo.commands) setpoints.push_back(command.setpoint);
    return sim::setpoint_hash(setpoints);
  }
};

}  // namespace

TEST(a_full_line_of_good_and_bad_requests_leaves_a_shaped_move_as_it_is) {
  const uint64_t undisturbed = FloodedMove().run(nullptr);
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    TEST_INFO("seed", seed);
    FloodedMove flooded;
    const uint32_t before = flooded.drive.client_counters().requests;
    Flood flood(seed);
    const uint64_t hash = flooded.run(&flood);
    TEST_ASSERT_EQUAL_UINT64(undisturbed, hash);
    // It was heard: requests taken, and some of each kind of what must be dropped.
    const firmware::RtuCounters& counters = flooded.drive.client_counters();
    TEST_ASSERT_AT_LEAST_INT64(100, counters.requests - before);
    TEST_ASSERT_AT_LEAST_INT64(20, counters.crc_errors);
    TEST_ASSERT_AT_LEAST_INT64(5, counters.runts);
    TEST_ASSERT_AT_LEAST_INT64(5, counters.others);
    TEST_ASSERT_AT_LEAST_INT64(5, counters.oversize);
  }
}

// The comparison can fail: one controlword among them ends the move.
TEST(a_request_that_halts_changes_the_hash) {
  const uint64_t undisturbed = FloodedMove().run(nullptr);
  struct Halted : FloodedMove {
    uint64_t halted() {
      start_move(1700000);
      step(300);
      control(0x010F);
      step(2200);
      std::vector<Signal> setpoints;
      for (const hal::ServoCommand& command : servo.commands) setpoints.push_back(command.setpoint);
      return sim::setpoint_hash(setpoints);
    }
  };
  TEST_ASSERT_TRUE(Halted().halted() != undisturbed);
}
