// SPDX-License-Identifier: Apache-2.0
// Save, defaults and reset as a client sees them, through the whole drive, over power cycles.
#include <memory>

#include "tests/firmware/drive402.hpp"
#include "tests/support/flash_model.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kBusy = 6;
constexpr uint32_t kSave = 0x5341;
constexpr uint32_t kDefaults = 0x4C44;
constexpr uint32_t kReset = 0x5253;
enum Result : uint32_t { kIdle, kUnderWay, kDone, kFailed };

uint32_t restarts = 0;
void restart() { ++restarts; }

// A drive with the memory that it is given; another one on the same memory is the next start.
struct Stored : Drive402 {
  explicit Stored(hal::Nonvolatile* memory, uint32_t modulo_counts = 0) {
    AxisConfig config = firmware::kDefaultAxis;
    config.modulo_counts = modulo_counts;
    TEST_ASSERT_OK(axis.configure(config));
    drive.begin(axis, {&servo, &line, &dog, &faults, nullptr, memory, restart});
  }

  uint32_t command(uint32_t key) {
    unlock();
    const uint32_t refused = write_single(0x0014, key);
    if (refused == 0) step(50);
    return refused;
  }
  uint32_t result() { return get(0x0015); }
};

struct Memory {
  FlashModel flash;
  std::unique_ptr<Stored> now = std::make_unique<Stored>(&flash);

  void power_cycle() { now = std::make_unique<Stored>(&flash); }
};

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
  Stored rotary(&flash, 100000);
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
  auto& page = flash.pages[0];
  const uint32_t end = 3 + (page[1] & 0xFFFF);
  for (size_t i = 3; i < end; i += 2) {
    if (page[i] == 0x0060) page[i + 1] = UINT32_MAX;
  }
  uint32_t crc = UINT32_MAX;
  for (size_t i = 0; i < end; ++i) {
    for (int bit = 0; bit < 32; ++bit) crc = ((crc ^ (page[i] >> bit)) & 1) != 0 ? (crc >> 1) ^ 0xEDB88320 : crc >> 1;
  }
  page[end] = ~crc;
  power_cycle();
  TEST_ASSERT_EQUAL_UINT32(10000000, now->get_wide(0x0060));
}

// 11 Hz, 0.11, of this kind, staged in this set and applied.
void apply(Stored& drive, uint16_t set, uint16_t kind) {
  TEST_ASSERT_EQUAL_UINT32(0, drive.write(0x0100, {1, set, 0x0001, 0xADB0, 11000, 500, kind}));
  TEST_ASSERT_EQUAL_UINT32(0, drive.write_single(0x0130, 1));
  drive.step(100);
  TEST_ASSERT_EQUAL_UINT32(1, drive.get(0x0131));
}

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
    apply(*now, 6, kind);
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
  apply(*now, 0, 1);
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
  apply(*now, 0, 1);
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
  apply(*now, 0, 1);
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
  apply(*now, 0, 7);
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

// Saved where the line is as long as it is; a firmware with a slower tick, or a shorter line, cannot hold it.
TEST_F(Memory, a_shaper_that_is_refused_at_the_start_is_named_and_the_drive_starts_without) {
  TEST_ASSERT_EQUAL_UINT32(0, now->write(0x0100, {1, 0, 0, 5000, 0, 0, 2}));  // a ZVD of 0.5 Hz: as long as fits
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 1));
  now->step(100);
  TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  auto& page = flash.pages[0];
  const uint32_t end = 3 + (page[1] & 0xFFFF);
  for (size_t i = 3; i < end; i += 2) {
    if (page[i] == (8U << 16 | 0x0102U)) page[i + 1] = 2500;
  }
  uint32_t crc = UINT32_MAX;
  for (size_t i = 0; i < end; ++i) {
    for (int bit = 0; bit < 32; ++bit) crc = ((crc ^ (page[i] >> bit)) & 1) != 0 ? (crc >> 1) ^ 0xEDB88320 : crc >> 1;
  }
  page[end] = ~crc;
  power_cycle();
  now->step(5);
  TEST_ASSERT_EQUAL_UINT32(0, now->axis.shaper().stage_count);
  TEST_ASSERT_EQUAL_UINT32(3, now->get(0x0131));
  TEST_ASSERT_TRUE(now->get(0x0132) != 0);
  TEST_ASSERT_EQUAL_UINT32(now->get(0x0132), now->get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0x0102, now->get(0x0013));
  TEST_ASSERT_EQUAL_UINT32(4, now->get(0x0011));
  now->enable();
  TEST_ASSERT_EQUAL_UINT32(0x80, now->status() & 0x80);
  now->start_move(20000);
  now->step(1000);
  TEST_ASSERT_EQUAL_INT64(20000 * kCount, now->servo.setpoint());
  apply(*now, 1, 1);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0011));
}

TEST_F(Memory, defaults_take_the_shaper_off_and_it_stays_off_once_they_are_saved) {
  apply(*now, 2, 1);
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
