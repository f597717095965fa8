// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/firmware/fault_runs.hpp"
#include "tests/firmware/faulty_drive_on_host.hpp"

namespace {

using namespace stillpoint::testing;

TEST_HOST(a_hundred_faults_at_any_moment_of_any_move) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  Random random(seed);
  uint32_t moved = 0;
  for (uint32_t run = 0; run < 100; ++run) {
    TEST_INFO("run", run);
    const auto drive = std::make_unique<FaultyDriveOnHost>();
    FaultRun one(*drive, random, kProvoked[run % kProvokedCount]);
    one();
    if (one.moved()) ++moved;
  }
  TEST_ASSERT_AT_LEAST_INT64(50, moved);
}

}  // namespace
