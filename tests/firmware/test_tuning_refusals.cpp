// SPDX-License-Identifier: Apache-2.0
// What cannot be tuned, and what cannot be done while it is: named, and nothing moves.
#include "tests/firmware/tune_rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kNotStanding = 0x8100, kHalted = 0x8200, kNotAvailable = 0x8400, kOutOfRange = 0x8500,
                   kNotEnabled = 0x9000, kTuning = 0x9100, kNothingToDo = 0x9200;

struct Refused : Tunable {
  void expect_no_start(uint32_t reason, uint32_t culprit) {
    arm.forget();
    TEST_ASSERT_EQUAL_UINT32(6, tune(kStart));
    expect_refused(reason, culprit);
    step(500);
    TEST_ASSERT_TRUE(still());
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0208));
  }
};

TEST_F(TuneRig, it_starts_in_operation_enabled_only) {
  for (const uint32_t word : {0x00U, 0x06U, 0x07U}) {
    control(word);
    TEST_ASSERT_EQUAL_UINT32(6, tune(kStart));
    expect_refused(kNotEnabled, 0x0200);
  }
  arm.forget();
  step(500);
  TEST_ASSERT_TRUE(still());
  control(0x0F);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
}

TEST_F(Refused, it_does_not_start_in_a_fault) {
  arm.drive.set_valid(false);
  step(10);
  expect_no_start(kNotEnabled, 0x0200);
}

TEST_F(Refused, it_does_not_start_while_the_axis_moves) {
  start_move(1700000);
  TEST_ASSERT_EQUAL_UINT32(6, tune(kStart));
  expect_refused(kNotStanding, 0x0200);
  control(0x0F);
  step(3000);
  TEST_ASSERT_EQUAL_INT64(1700000 * kCount, arm.setpoints.back());
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
}

TEST_F(Refused, it_does_not_start_while_halted) {
  control(0x10F);
  expect_no_start(kHalted, 0x0200);
}

// Bit 4 of the controlword asks for nothing in profile velocity.
TEST_F(Refused, it_starts_in_profile_velocity_whatever_bit_4_says) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, 3));
  step(20);
  control(0x1F);
  step(20);
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
}

TEST_F(Refused, it_does_not_start_while_a_shaper_waits) {
  arm.drive.set_commit(false);
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, 0, 0x0006, 0x1A80, 0, 0, 1, 0, 0, 0}));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
  expect_no_start(kNotStanding, 0x0200);
  TEST_ASSERT_EQUAL_UINT32(2, get(0x0131));
}

TEST_F(Refused, an_amplitude_above_the_travel_names_the_one_that_would_do) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0204, 60000));
  expect_no_start(firmware::reason_of(Error::kAboveMaximum, Quantity::kTravel), 0x0202);
  TEST_ASSERT_EQUAL_UINT32(60000, get_wide(0x0016));
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0202, 60000));
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
}

// Bands that are inverted, too high for the ticks, too low for the record: what is named and taken leads to a start.
TEST_F(Refused, a_band_that_cannot_be_looked_at_is_refused_with_one_that_can) {
  struct Row {
    uint16_t low, high;
  };
  for (const Row& row : {Row{500, 300}, Row{10, 6000}, Row{1, 4000}, Row{3000, 65535}}) {
    TEST_INFO("from", row.low);
    TEST_INFO("to", row.high);
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0206, {row.low, row.high}));
    arm.forget();
    TEST_ASSERT_EQUAL_UINT32(6, tune(kStart));
    uint32_t refusals = 0;
    do {
      TEST_ASSERT_AT_MOST_INT64(2, ++refusals);
      TEST_ASSERT_EQUAL_UINT32(static_cast<uint32_t>(Quantity::kFrequency), get(0x0012) & 0xFF);
      const uint32_t culprit = get(0x0013);
      const uint32_t accepted = get_wide(0x0016);
      TEST_ASSERT_TRUE(culprit == 0x0206 || culprit == 0x0207);
      TEST_ASSERT_TRUE(still());
      TEST_ASSERT_EQUAL_UINT32(0, write_single(culprit, accepted));
    } while (tune(kStart) != 0);
    TEST_ASSERT_EQUAL_UINT32(0, tune(kAbort));
    reach_end();
  }
}

TEST_F(Refused, a_profile_beyond_the_axis_names_its_register) {
  AxisConfig slower = axis.config();
  slower.maximum.velocity = 1e6;  // below the 1,200,000 of 0060
  TEST_ASSERT_OK(axis.configure(slower));
  expect_no_start(firmware::reason_of(Error::kAboveMaximum, Quantity::kVelocity), 0x0060);
  TEST_ASSERT_EQUAL_UINT32(1000000, get_wide(0x0016));
}

TEST_F(Refused, an_amplitude_beyond_both_soft_limits_names_what_there_is_room_for) {
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0074, {0xFFFF, 0x3CB0, 1, 0x1170}));  // -50,000 to 70,000
  expect_no_start(firmware::reason_of(Error::kAboveMaximum, Quantity::kPosition), 0x0202);
  TEST_ASSERT_EQUAL_UINT32(70000, get_wide(0x0016));
}

TEST_F(Refused, an_amplitude_beyond_the_position_range_names_what_there_is_room_for) {
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0202, {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF}));
  expect_no_start(firmware::reason_of(Error::kAboveMaximum, Quantity::kAmplitude), 0x0202);
  TEST_ASSERT_EQUAL_UINT32(INT32_MAX, get_wide(0x0016));
}

TEST_F(Refused, what_the_axis_refuses_on_the_way_ends_it_with_the_reason) {
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  AxisConfig slower = axis.config();
  slower.maximum.velocity = 1e6;
  TEST_ASSERT_OK(axis.configure(slower));
  reach(TuneState::kFailed);
  TEST_ASSERT_EQUAL_UINT32(6, get(0x020A));
  expect_refused(firmware::reason_of(Error::kAboveMaximum, Quantity::kVelocity), 0x0060);
  TEST_ASSERT_EQUAL_UINT32(1000000, get_wide(0x0016));
  TEST_ASSERT_TRUE(still());
}

TEST_F(Refused, values_out_of_range_never_reach_the_tuner) {
  struct Row {
    uint32_t address, value, reason, accepted;
  };
  constexpr Row kRows[] = {{0x0200, 0, kNotAvailable, 0}, {0x0200, 5, kOutOfRange, 4},
                           {0x0201, 5, kOutOfRange, 4},   {0x020C, 3, kOutOfRange, 2},
                           {0x020E, 9, kOutOfRange, 10},  {0x020E, 2001, kOutOfRange, 2000},
                           {0x0206, 0, kOutOfRange, 1},   {0x0248, 2, kOutOfRange, 1}};
  for (const Row& row : kRows) {
    TEST_INFO("register", row.address);
    TEST_ASSERT_EQUAL_UINT32(3, write_single(row.address, row.value));
    expect_refused(row.reason, row.address);
    TEST_ASSERT_EQUAL_UINT32(row.accepted, get_wide(0x0016));
  }
  TEST_ASSERT_EQUAL_UINT32(2, write_single(0x0208, 1));
  TEST_ASSERT_EQUAL_UINT32(2, write_single(0x0213, 1));
}

// One write: the start goes by what comes with it, and where it is refused nothing of that is taken.
TEST_F(Refused, a_start_written_with_its_settings_goes_by_them) {
  TEST_ASSERT_EQUAL_UINT32(6, write(0x0200, {1, 1, 0, 50000, 0, 40000}));
  expect_refused(firmware::reason_of(Error::kAboveMaximum, Quantity::kTravel), 0x0202);
  TEST_ASSERT_EQUAL_UINT32(100000, get_wide(0x0202));
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0200, {1, 1, 0, 50000, 0, 60000}));
  TEST_ASSERT_EQUAL_UINT32(50000, get_wide(0x0202));
  reach(TuneState::kProposed);
  TEST_ASSERT_DOUBLE_WITHIN(1.0, 50000.0, reach_from(0));
}

TEST_F(Refused, there_is_nothing_to_accept_or_undo_before) {
  for (const uint32_t command : {kAccept, kUndo}) {
    TEST_ASSERT_EQUAL_UINT32(6, tune(command));
    expect_refused(kNothingToDo, 0x0200);
  }
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAbort));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0208));
}

TEST_F(Refused, while_it_tunes_the_axis_takes_nothing_else) {
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {1, 0, 0x0006, 0x1A80, 0, 0, 1, 0, 0, 0}));
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
  for (const TuneState state : {TuneState::kExciting, TuneState::kCapturing, TuneState::kProposed}) {
    reach(state);
    TEST_INFO("state", static_cast<uint32_t>(state));
    TEST_ASSERT_EQUAL_UINT32(6, tune(kStart));
    expect_refused(kTuning, 0x0200);
    TEST_ASSERT_EQUAL_UINT32(6, write_single(0x0130, 1));
    expect_refused(kTuning, 0x0130);
    TEST_ASSERT_EQUAL_UINT32(6, write_wide(0x0058, 5000000));
    expect_refused(kTuning, 0x0058);
    start_move(5000);
    TEST_ASSERT_EQUAL_UINT32(0, status() & kTaken);
    expect_refused(kTuning, 0x0040);
    control(0x0F);
  }
  TEST_ASSERT_EQUAL_UINT32(0, tune(kAccept));
  reach(TuneState::kKept);
  TEST_ASSERT_EQUAL_INT64(0, arm.setpoints.back());
  step(100);
  TEST_ASSERT_EQUAL_INT64(0, arm.setpoints.back());
  ringing_after_move(5000);
}

TEST(a_drive_without_memory_for_it_says_so) {
  Rig rig;
  Axis<firmware::kLineCapacity> axis;
  firmware::Application other;
  TEST_ASSERT_OK(axis.configure(firmware::kDefaultAxis));
  other.begin(axis, {&rig.servo, &rig.line, &rig.dog});
  const auto ask = [&](const Bytes& request) {
    rig.send(framed(request));
    for (int i = 0; i < 20; ++i) {
      other.tick();
      other.poll();
    }
    return rig.answer();
  };
  TEST_ASSERT_TRUE(ask({1, 6, 0x02, 0x00, 0, 1}) == Bytes({0x86, 6}));
  TEST_ASSERT_TRUE(ask({1, 3, 0x00, 0x12, 0, 2}) == Bytes({3, 4, 0x84, 0x00, 0x02, 0x00}));
}

}  // namespace
