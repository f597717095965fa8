// SPDX-License-Identifier: Apache-2.0
// A drive linked with no_tuner.cpp: what it cannot do is refused by name, the rest is there.
#include "tests/firmware/drive402.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kNotAvailable = 0x8400;

TEST_F(Enabled402, no_command_of_the_tuner_is_taken) {
  for (const uint32_t command : {1U, 2U, 3U, 4U}) {
    TEST_ASSERT_EQUAL_UINT32(6, write_single(0x0200, command));
    expect_refused(kNotAvailable, 0x0200);
  }
  // Nor with what it would take beside it, and that stays as it was.
  const uint32_t amplitude = get_wide(0x0202);
  TEST_ASSERT_EQUAL_UINT32(6, write(0x0200, {1, 1, 0, 5000}));
  expect_refused(kNotAvailable, 0x0200);
  TEST_ASSERT_EQUAL_UINT32(amplitude, get_wide(0x0202));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0201));
  const size_t sent = servo.commands.size();
  step(500);
  for (size_t i = sent; i < servo.commands.size(); ++i) {
    TEST_ASSERT_EQUAL_INT64(servo.commands[sent].setpoint, servo.commands[i].setpoint);
  }
}

TEST_F(Enabled402, modes_are_not_followed) {
  for (const uint32_t what : {1U, 2U}) {
    TEST_ASSERT_EQUAL_UINT32(6, write_single(0x0250, what));
    expect_refused(kNotAvailable, 0x0250);
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0250));
  }
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0250, 0));
}

TEST_F(Enabled402, every_register_of_it_reads_nothing) {
  for (const uint16_t word : read(0x0208, 4)) TEST_ASSERT_EQUAL_UINT32(0, word);
  for (const uint16_t word : read(0x0210, 32)) TEST_ASSERT_EQUAL_UINT32(0, word);
  for (const uint16_t word : read(0x0230, 24)) TEST_ASSERT_EQUAL_UINT32(0, word);
}

TEST_F(Enabled402, what_the_client_tunes_by_is_staged_and_kept) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0202, 5000));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x020E, 300));
  TEST_ASSERT_EQUAL_UINT32(5000, get_wide(0x0202));
  TEST_ASSERT_EQUAL_UINT32(300, get(0x020E));
}

TEST_F(Enabled402, the_scope_has_the_memory) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0307, 0));
  TEST_ASSERT_EQUAL_UINT32(0, write(0x030A, {2, 0, 0, 0}));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0300, 1));
  start_move(20000);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0300, 2));
  step(3000);
  TEST_ASSERT_EQUAL_UINT32(3, get(0x0301));
  TEST_ASSERT_EQUAL_UINT32(2048, get(0x0310));
}

TEST_F(Enabled402, a_set_is_applied_and_shapes) {
  // ZV at 11 Hz, 0.11: with K = exp(-pi 0.11 / sqrt(1 - 0.11^2)), K / (1 + K) half periods on the mean: 18,930.5 us.
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, 0, 0x0001, 0xADB0, 11000, 0, 1}));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  step(100);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0132));
  TEST_ASSERT_DOUBLE_WITHIN(10.0, 18930.5, get_wide(0x0134));
}

}  // namespace
