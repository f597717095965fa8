// SPDX-License-Identifier: Apache-2.0
// Save, defaults and reset as a client sees them, through the whole drive, over power cycles.
#include "firmware/parameter_keeper.hpp"

#include "tests/firmware/stored_drive.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

TEST_F(Memory, everything_written_and_saved_is_there_after_a_power_cycle) {
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0060, 345678));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 6));
  TEST_ASSERT_EQUAL_UINT32(0, now->write(0x0100, {1, 6, 0x0001, 0xADB0, 11000, 0, 1}));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 2));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0100, 4));
  now->unlock();
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0058, 12345678));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0074, -5000000));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0076, 6000000));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0044, 777));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  TEST_ASSERT_EQUAL_UINT32(kDone, now->result());
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0060, 1));  // not saved
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(345678, now->get_wide(0x0060));
  TEST_ASSERT_EQUAL_UINT32(12345678, now->get_wide(0x0058));
  TEST_ASSERT_EQUAL_INT32(-5000000, now->get_wide(0x0074));
  TEST_ASSERT_EQUAL_UINT32(0, now->get_wide(0x0044));  // a set-point is no parameter
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 12345678.0, now->axis.config().maximum.velocity);
  TEST_ASSERT_EQUAL_INT32(6000000, now->axis.config().soft_high_counts);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0100));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 2));
  TEST_ASSERT_EQUAL_UINT32(4, now->get(0x0100));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 6));
  TEST_ASSERT_EQUAL_UINT32(110000, now->get_wide(0x0102));
  now->enable();  // and it works
  now->start_move(20000);
  now->step(1000);
  TEST_ASSERT_EQUAL_INT64(20000 * kCount, now->servo.setpoint());
}

TEST_F(Memory, the_pulse_ratio_changes_with_the_next_start) {
  TEST_ASSERT_EQUAL_UINT32(1, now->get_wide(0x00D0));
  TEST_ASSERT_EQUAL_UINT32(100, now->get_wide(0x00D2));
  TEST_ASSERT_EQUAL_UINT32(6, now->write_wide(0x00D2, 64));  // locked
  now->unlock();
  TEST_ASSERT_EQUAL_UINT32(3, now->write_wide(0x00D0, 0));
  TEST_ASSERT_EQUAL_UINT32(1, now->get_wide(0x0016));
  TEST_ASSERT_EQUAL_UINT32(3, now->write_wide(0x00D2, 0x80000000));
  TEST_ASSERT_EQUAL_UINT32(0x7FFFFFFF, now->get_wide(0x0016));
  TEST_ASSERT_EQUAL_UINT32(0, now->write(0x00D0, {0, 5, 0x7FFF, 0xFFFF}));
  TEST_ASSERT_EQUAL_UINT32(1, now->drive.pulse_ratio().pulses);
  TEST_ASSERT_EQUAL_UINT32(100, now->drive.pulse_ratio().counts);
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(5, now->drive.pulse_ratio().pulses);
  TEST_ASSERT_EQUAL_UINT32(0x7FFFFFFF, now->drive.pulse_ratio().counts);
}

TEST_F(Memory, the_unit_id_changes_with_the_next_start) {
  now->unlock();
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0020, 42));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  TEST_ASSERT_EQUAL_UINT32(kDone, now->result());
  power_cycle();
  TEST_ASSERT_TRUE(now->exchange({3, 0x00, 0x20, 0, 1}, 1).empty());
  TEST_ASSERT_TRUE(now->exchange({3, 0x00, 0x20, 0, 1}, 42) == Bytes({3, 2, 0, 42}));
}

TEST_F(Memory, the_line_changes_with_the_next_start) {
  TEST_ASSERT_EQUAL_UINT32(115200, now->drive.line().baud);
  TEST_ASSERT_TRUE(now->drive.line().format == firmware::LineFormat::k8E1);
  TEST_ASSERT_EQUAL_UINT32(6, now->write_single(0x0021, 0));  // locked
  now->unlock();
  TEST_ASSERT_EQUAL_UINT32(3, now->write_single(0x0021, 8));
  TEST_ASSERT_EQUAL_UINT32(3, now->write_single(0x0022, 4));
  TEST_ASSERT_EQUAL_UINT32(0, now->write(0x0021, {0, 3}));
  TEST_ASSERT_EQUAL_UINT32(115200, now->drive.line().baud);
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  TEST_ASSERT_EQUAL_UINT32(kDone, now->result());
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(9600, now->drive.line().baud);
  TEST_ASSERT_TRUE(now->drive.line().format == firmware::LineFormat::k8N2);
  // A gap of 4 ms is none at that rate: 3.5 characters are.
  const Bytes request = framed({1, 3, 0x00, 0x21, 0, 2});
  now->send({request.begin(), request.begin() + 4});
  now->step(4);
  now->send({request.begin() + 4, request.end()});
  now->step(20);
  TEST_ASSERT_TRUE(now->answer() == Bytes({3, 4, 0, 0, 0, 3}));
}

TEST_F(Memory, a_command_is_answered_first_and_done_after) {
  now->unlock();
  TEST_ASSERT_EQUAL_UINT32(0, flash.operations());
  const Bytes request = framed({1, 6, 0x00, 0x14, 0x53, 0x41});
  now->line.from_drive.clear();
  now->send(request);
  now->step(5);
  TEST_ASSERT_TRUE(now->line.from_drive == request);
  now->step(12);
  TEST_ASSERT_EQUAL_UINT32(0, flash.operations());
  now->step(10);
  TEST_ASSERT_AT_LEAST_INT64(300, flash.operations());
}

TEST_F(Memory, nothing_is_done_unless_the_drive_is_disabled) {
  for (const uint32_t key : {kSave, kDefaults, kReset}) {
    TEST_INFO("key", key);
    power_cycle();
    now->control(0x06);
    now->control(0x07);
    for (const uint8_t word : Bytes{0x07, 0x0F}) {
      now->control(word);
      TEST_ASSERT_EQUAL_UINT32(kBusy, now->command(key));
      TEST_ASSERT_EQUAL_UINT32(0x8800, now->get(0x0012));
      TEST_ASSERT_EQUAL_UINT32(kFailed, now->result());
    }
  }
  TEST_ASSERT_EQUAL_UINT32(0, flash.operations());
  TEST_ASSERT_EQUAL_UINT32(0, restarts);
}

TEST_F(Memory, a_drive_that_is_switched_on_before_a_save_begins_is_not_stopped_by_it) {
  now->control(0x06);
  now->unlock();
  now->line.from_drive.clear();
  now->send(framed({1, 6, 0x00, 0x14, 0x53, 0x41}));
  now->step(5);
  now->send(framed({1, 6, 0x00, 0x40, 0x00, 0x0F}));
  now->step(50);
  TEST_ASSERT_EQUAL_UINT32(0x0027, now->state());
  TEST_ASSERT_EQUAL_UINT32(kFailed, now->result());
  TEST_ASSERT_EQUAL_UINT32(0x8800, now->get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0, flash.operations());
}

TEST_F(Memory, a_command_waits_for_the_one_before) {
  now->unlock();
  now->send(framed({1, 6, 0x00, 0x14, 0x53, 0x41}));
  now->step(5);
  now->line.from_drive.clear();
  now->send(framed({1, 6, 0x00, 0x14, 0x52, 0x53}));
  now->step(5);
  TEST_ASSERT_TRUE(now->answer() == Bytes({0x86, kBusy}));
  now->step(50);
  TEST_ASSERT_EQUAL_UINT32(kDone, now->result());
  TEST_ASSERT_EQUAL_UINT32(0, restarts);
}

TEST_F(Memory, a_flash_that_does_not_respond_fails_the_save_by_name) {
  flash.dead = true;
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  TEST_ASSERT_EQUAL_UINT32(kFailed, now->result());
  TEST_ASSERT_EQUAL_UINT32(0x8900, now->get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0x0014, now->get(0x0013));
  Stored without(nullptr);
  TEST_ASSERT_EQUAL_UINT32(0, without.command(kSave));
  TEST_ASSERT_EQUAL_UINT32(kFailed, without.result());
  TEST_ASSERT_EQUAL_UINT32(0x8900, without.get(0x0012));
}

TEST_F(Memory, defaults_are_the_delivered_ones_and_not_stored_until_they_are_saved) {
  now->unlock();
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0058, 3000000));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0060, 2000000));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 3));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0100, 2));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(3000000, now->get_wide(0x0058));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kDefaults));
  TEST_ASSERT_EQUAL_UINT32(kDone, now->result());
  TEST_ASSERT_EQUAL_UINT32(10000000, now->get_wide(0x0058));
  TEST_ASSERT_EQUAL_UINT32(1200000, now->get_wide(0x0060));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 1e7, now->axis.config().maximum.velocity);
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 3));
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0100));
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(3000000, now->get_wide(0x0058));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kDefaults));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(10000000, now->get_wide(0x0058));
}

TEST_F(Memory, a_reset_calls_the_target_where_it_can) {
  const uint32_t before = restarts;
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kReset));
  TEST_ASSERT_EQUAL_UINT32(before + 1, restarts);
  Rig plain;
  plain.unlock();
  TEST_ASSERT_EQUAL_UINT32(kBusy, plain.write_single(0x0014, kReset));
  TEST_ASSERT_EQUAL_UINT32(0x8400, plain.get(0x0012));
  restarts = before;
}

TEST_F(Memory, images_that_cannot_be_used_are_named_and_the_defaults_are_in_force) {
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0060, 345678));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  const FlashModel good = flash;
  flash.pages[0][10] ^= 1;
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(1200000, now->get_wide(0x0060));
  TEST_ASSERT_EQUAL_UINT32(0x8A01, now->get(0x0012));
  flash = good;
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(345678, now->get_wide(0x0060));
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0012));
}

// Saved by a linear axis between soft limits, started on a rotary one, which has none.
TEST_F(Memory, limits_that_the_axis_does_not_take_are_the_delivered_ones) {
  now->unlock();
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0058, 3000000));
  TEST_ASSERT_EQUAL_UINT32(0, now->write(0x0074, {0, 0, 0, 1000}));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0072, 33));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  AxisConfig config = firmware::kDefaultAxis;
  config.modulo_counts = 100000;
  Stored rotary(&flash, config);
  TEST_ASSERT_EQUAL_UINT32(0x0058, rotary.get(0x0013));
  TEST_ASSERT_TRUE(rotary.get(0x0012) != 0);
  TEST_ASSERT_EQUAL_UINT32(10000000, rotary.get_wide(0x0058));
  TEST_ASSERT_EQUAL_UINT32(0, rotary.get_wide(0x0076));
  TEST_ASSERT_EQUAL_UINT32(33, rotary.get(0x0072));  // the rest is as it was saved
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 1e7, rotary.axis.config().maximum.velocity);
}

// As an image of another firmware can have it: more than the axis's maximum, which a client cannot write.
TEST_F(Memory, a_profile_beyond_the_axis_is_lowered_to_it) {
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  replace(0x0060, UINT32_MAX);
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(10000000, now->get_wide(0x0060));
  now->expect_refused(0x8500, 0x0060);
  TEST_ASSERT_EQUAL_UINT32(10000000, now->get_wide(0x0016));
}

TEST_F(Memory, a_value_out_of_its_range_is_left_out_and_named) {
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0060, 345678));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  replace(0x0088, 5000);
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(10, now->get(0x0088));
  TEST_ASSERT_EQUAL_UINT32(345678, now->get_wide(0x0060));
  now->expect_refused(0x8500, 0x0088);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0010));
}

// Whoever went back to an older firmware is told so, and has what that one saved last.
TEST_F(Memory, an_older_set_than_the_newest_that_is_there_is_named) {
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0060, 345678));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  flash.pages[1] = flash.pages[0];
  flash.pages[1][1] += 0x10000;
  flash.pages[1][2] += 1;
  make_whole(1);
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(345678, now->get_wide(0x0060));
  now->expect_refused(0x8A00, 0);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0010));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  power_cycle();
  now->expect_refused(0, 0);
}

}  // namespace
