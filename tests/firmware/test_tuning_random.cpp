// SPDX-License-Identifier: Apache-2.0
// A client that does anything at any time: what leaves keeps the axis's limits, and afterwards the drive tunes.
#include <memory>

#include "tests/firmware/tune_rig.hpp"
#include "tests/support/random.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

struct AnyClient : Tunable {
  // One thing, answered or refused as it may be.
  void do_anything(Random& random) {
    switch (random.integer(0, 11)) {
      case 0: tune(kStart); break;
      case 1:
        bring_up();
        tune(kStart);
        step(5000);
        tune(kAccept);
        step(static_cast<uint32_t>(random.integer(1, 6000)));
        break;
      case 2: tune(kAccept); break;
      case 3: tune(static_cast<uint32_t>(random.integer(kAbort, kUndo))); break;
      case 4: write_single(0x0040, random.integer(0, 1) != 0 ? 0x10F : 0x02); break;
      case 5: write_single(0x0040, static_cast<uint32_t>(random.integer(0, 0x0F))); break;
      case 6:
        write_wide(0x0044, random.integer(-100000, 100000));
        write_single(0x0040, 0x1F);
        break;
      case 7:
        write(0x0100, {1, static_cast<uint16_t>(random.integer(0, 7)), 3, 0x5B60, 4000, 0, 1, 0, 0, 0});  // ZV of 22 Hz
        write_single(0x0130, static_cast<uint32_t>(random.integer(1, 3)));
        break;
      case 8:
        arm.drive.set_valid(false);
        step(static_cast<uint32_t>(random.integer(1, 5)));
        arm.drive.set_valid(true);
        break;
      case 9:
        arm.drive.set_commit(false);
        step(static_cast<uint32_t>(random.integer(1, 50)));
        arm.drive.set_commit(true);
        break;
      case 10: step_silent(static_cast<uint32_t>(random.integer(1, 200))); break;
      default: write_single(0x0248, static_cast<uint32_t>(random.integer(0, 1))); break;
    }
    if (random.integer(0, 2) == 0) bring_up();
    step(static_cast<uint32_t>(random.integer(1, random.integer(0, 3) == 0 ? 3000 : 200)));
  }

  void bring_up() {
    for (const uint32_t word : {0x00U, 0x80U, 0x00U, 0x06U, 0x07U, 0x0FU}) {
      write_single(0x0040, word);
      step(3);
    }
  }

  // Between ticks that were all under torque; a drive that is off goes on from where it stands.
  void expect_within_limits() const {
    const double most = 1.001e9 * 1e-6 * static_cast<double>(kCount);
    for (size_t i = 3; i < arm.setpoints.size(); ++i) {
      if (!arm.enabled_at[i] || !arm.enabled_at[i - 1] || !arm.enabled_at[i - 2] || !arm.enabled_at[i - 3]) continue;
      const int64_t* s = &arm.setpoints[i];
      TEST_ASSERT_TRUE(std::fabs(static_cast<double>(s[0] - 2 * s[-1] + s[-2])) <= most);
    }
  }
};

TEST(a_hundred_clients_that_do_anything) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  Random random(seed);
  uint32_t kept_on_the_way = 0;
  uint32_t failed_on_the_way = 0;
  for (uint32_t run = 0; run < 100; ++run) {
    TEST_INFO("run", run);
    const auto client = std::make_unique<AnyClient>();
    for (int i = 0; i < 30; ++i) {
      client->do_anything(random);
      kept_on_the_way += client->tune_state() == TuneState::kKept ? 1U : 0U;
      failed_on_the_way += client->tune_state() == TuneState::kFailed ? 1U : 0U;
    }
    client->expect_within_limits();
    client->tune(kAbort);
    client->step(500);
    client->bring_up();
    client->reach_end();
    client->step(3000);
    TEST_ASSERT_EQUAL_UINT32(0, client->write_single(0x0248, 0));
    client->run_to_kept();
    TEST_ASSERT_DOUBLE_WITHIN(0.005 * 110000, 110000.0, client->get_wide(0x0210));
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * 11000, 11000.0, client->get(0x0212));
    TEST_ASSERT_EQUAL_UINT32(1, client->get(0x0131));
  }
  // It is not only refusals that were seen.
  TEST_ASSERT_AT_LEAST_INT64(20, kept_on_the_way);
  TEST_ASSERT_AT_LEAST_INT64(20, failed_on_the_way);
}

}  // namespace
