// SPDX-License-Identifier: Apache-2.0
// The shaper in force over power cycles, as a client sees it.
#include "tests/firmware/stored_drive.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

bool same_design(const ShaperDesign& a, const ShaperDesign& b) {
  if (a.stage_count != b.stage_count || a.tap_count != b.tap_count) return false;
  for (uint32_t i = 0; i < a.tap_count; ++i) {
    if (a.taps[i].delay_ticks != b.taps[i].delay_ticks || a.taps[i].gain != b.taps[i].gain) return false;
  }
  return true;
}

TEST_F(Memory, the_shaper_in_force_is_in_force_again_after_a_power_cycle) {
  for (const uint16_t kind : std::initializer_list<uint16_t>{1, 2, 5}) {
    TEST_INFO("kind", kind);
    now->apply(6, kind);
    // Edited since, and not applied: that stays staged.
    TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0102, 123456));
    TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
    TEST_ASSERT_EQUAL_UINT32(kDone, now->result());
    const ShaperDesign before = now->axis.shaper();
    const uint32_t delay_us = now->get_wide(0x0134);
    const uint32_t residual = now->get(0x0136);
    power_cycle();
    now->step(5);
    TEST_ASSERT_TRUE(same_design(before, now->axis.shaper()));
    TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0131));
    TEST_ASSERT_EQUAL_UINT32(delay_us, now->get_wide(0x0134));
    TEST_ASSERT_EQUAL_UINT32(residual, now->get(0x0136));
    TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0011));
    TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0012));
    TEST_ASSERT_EQUAL_UINT32(0, now->status() & 0x80);
    TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 6));
    TEST_ASSERT_EQUAL_UINT32(123456, now->get_wide(0x0102));
    TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 3));  // back to what is in force
    TEST_ASSERT_EQUAL_UINT32(110000, now->get_wide(0x0102));
  }
  now->enable();
  now->start_move(20000);
  now->step(1000);
  TEST_ASSERT_EQUAL_INT64(20000 * kCount, now->servo.setpoint());
}

TEST_F(Memory, without_a_shaper_in_force_none_is_after_a_power_cycle) {
  now->apply(0, 1);
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0100, 0));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 1));
  now->step(10);
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0100, 1));  // staged again
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  power_cycle();
  now->step(5);
  TEST_ASSERT_EQUAL_UINT32(0, now->axis.shaper().stage_count);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0100));
}

// Old or new, never none and never half of each: the frequency staged and the one that is in force belong together.
TEST_F(Memory, a_save_that_was_cut_leaves_one_shaper_in_force) {
  now->apply(0, 1);
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  const uint32_t old_us = now->get_wide(0x0134);
  TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0102, 132000));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 1));
  now->step(50);
  const uint32_t new_us = now->get_wide(0x0134);
  TEST_ASSERT_TRUE(old_us != new_us);
  const FlashModel before = flash;
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  const uint64_t operations = flash.operations() - before.operations();
  uint32_t seen[2] = {};
  for (uint64_t at = 0; at<operations; at += operations - at> 40 ? 13 : 1) {
    TEST_INFO("at", at);
    flash = before;
    power_cycle();
    now->step(5);
    TEST_ASSERT_EQUAL_UINT32(old_us, now->get_wide(0x0134));
    TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0102, 132000));
    TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 1));
    now->step(5);
    now->unlock();
    flash.cut_at(at, at);
    TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0014, kSave));
    now->step(50);
    flash.power_up();
    power_cycle();
    now->step(5);
    const bool is_new = now->get_wide(0x0134) == new_us;
    TEST_ASSERT_EQUAL_UINT32(is_new ? new_us : old_us, now->get_wide(0x0134));
    TEST_ASSERT_EQUAL_UINT32(is_new ? 132000 : 110000, now->get_wide(0x0102));
    ++seen[is_new ? 1 : 0];
  }
  TEST_ASSERT_AT_LEAST_INT64(20, seen[0]);
}

// The link holds its commits back; whoever enables and commands meanwhile waits for the shaper.
TEST_F(Memory, no_motion_begins_before_the_shaper_is_in_force) {
  now->apply(0, 1);
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  power_cycle();
  now->servo.commit = false;
  TEST_ASSERT_EQUAL_UINT32(0, now->axis.shaper().stage_count);
  now->step(3);
  TEST_ASSERT_EQUAL_UINT32(2, now->get(0x0131));  // pending
  TEST_ASSERT_EQUAL_UINT32(4, now->get(0x0011));
  TEST_ASSERT_EQUAL_UINT32(0x80, now->status() & 0x80);
  now->enable();
  now->start_move(50000);
  now->step(500);
  TEST_ASSERT_EQUAL_INT64(0, now->servo.setpoint());
  now->servo.commit = true;
  now->step(5);
  TEST_ASSERT_TRUE(now->axis.shaper().stage_count != 0);
  now->step(1000);
  TEST_ASSERT_EQUAL_INT64(50000 * kCount, now->servo.setpoint());
  TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0011));
}

// A design that takes long: the client is answered and may enable; what it commands waits.
TEST_F(Memory, the_drive_answers_while_it_designs) {
  now->apply(0, 7);
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  power_cycle();
  uint32_t reads = 0;
  now->line.on_read = [&] {
    if (++reads == 5) now->send(framed({1, 3, 0x01, 0x31, 0, 1}));
    if (reads > 4) {
      now->drive.tick();
      now->drive.own_timer_tick();
    }
  };
  now->drive.poll();
  now->line.on_read = nullptr;
  TEST_ASSERT_TRUE(now->answer() == Bytes({3, 2, 0, 2}));  // pending
  now->step(5);
  TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0131));
}

TEST_F(Memory, defaults_take_the_shaper_off_and_it_stays_off_once_they_are_saved) {
  now->apply(2, 1);
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kDefaults));
  now->step(5);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, now->axis.shaper().stage_count);
  power_cycle();
  now->step(5);
  TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kDefaults));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  power_cycle();
  now->step(5);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0131));
}

}  // namespace
