// SPDX-License-Identifier: Apache-2.0
// A stored shaper that the axis refuses at the start, as a client sees it.
#include "tests/firmware/stored_drive.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

// Saved where the line is as long as it is; a firmware with a slower tick, or a shorter line, cannot hold it.
TEST_F(Memory, a_shaper_that_is_refused_at_the_start_is_named_and_the_drive_starts_without) {
  TEST_ASSERT_EQUAL_UINT32(0, now->write(0x0100, {1, 0, 0, 5000, 0, 0, 2}));  // a ZVD of 0.5 Hz: as long as fits
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 1));
  now->step(100);
  TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
  replace(8U << 16 | 0x0102U, 2500);
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
  now->apply(1, 1);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0011));
}

// Of twice the ticks a second: what only just fits the line of the one that saved does not fit its own.
AxisConfig faster_axis() {
  AxisConfig config = firmware::kDefaultAxis;
  config.tick_s /= 2.0;
  return config;
}

// Saved by a drive that takes it, set 6 being a ZVD of 0.5 Hz edited since; now started on one that does not.
struct Refused : Memory {
  uint32_t delay_us = 0;

  Refused() {
    TEST_ASSERT_EQUAL_UINT32(0, now->write(0x0100, {1, 6, 0, 5000, 0, 0, 2}));
    TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 1));
    now->step(100);
    TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0131));
    delay_us = now->get_wide(0x0134);
    TEST_ASSERT_EQUAL_UINT32(0, now->write_wide(0x0102, 123456));
    save();
    start_refusing();
  }
  void save() {
    TEST_ASSERT_EQUAL_UINT32(0, now->command(kSave));
    TEST_ASSERT_EQUAL_UINT32(kDone, now->result());
  }
  void start_refusing() {
    now = std::make_unique<Stored>(&flash, faster_axis());
    now->step(5);
    TEST_ASSERT_EQUAL_UINT32(3, now->get(0x0131));
    TEST_ASSERT_EQUAL_UINT32(4, now->get(0x0011));
  }
  void start_accepting() {
    power_cycle();
    now->step(5);
    TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0011));
  }
};

TEST_F(Refused, a_save_stores_again_what_was_refused_at_the_start) {
  for (int saves = 0; saves < 3; ++saves) {  // either page
    save();
    start_refusing();
  }
  start_accepting();
  TEST_ASSERT_EQUAL_UINT32(1, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(2, now->axis.shaper().stage_count);
  TEST_ASSERT_EQUAL_UINT32(delay_us, now->get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 6));
  TEST_ASSERT_EQUAL_UINT32(123456, now->get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 3));
  TEST_ASSERT_EQUAL_UINT32(5000, now->get_wide(0x0102));
}

TEST_F(Refused, what_was_refused_at_the_start_can_be_read_and_does_not_count_as_running) {
  TEST_ASSERT_EQUAL_UINT32(0, now->get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0136));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0101, 6));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 3));
  TEST_ASSERT_EQUAL_UINT32(5000, now->get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0136));
  TEST_ASSERT_EQUAL_UINT32(4, now->get(0x0011));
}

TEST_F(Refused, an_apply_that_is_refused_too_does_not_take_its_place) {
  TEST_ASSERT_EQUAL_UINT32(0, now->write(0x0100, {1, 2, 0, 5000, 0, 0, 3}));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 1));
  now->step(100);
  TEST_ASSERT_EQUAL_UINT32(3, now->get(0x0131));
  save();
  start_accepting();
  TEST_ASSERT_EQUAL_UINT32(delay_us, now->get_wide(0x0134));
}

TEST_F(Refused, what_comes_into_force_takes_its_place) {
  now->apply(2, 1);
  const uint32_t own_us = now->get_wide(0x0134);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0011));
  save();
  start_accepting();
  TEST_ASSERT_EQUAL_UINT32(1, now->axis.shaper().stage_count);
  TEST_ASSERT_TRUE(now->get_wide(0x0134) - own_us + 1000 <= 2000);  // ticks of another length
}

TEST_F(Refused, no_shaper_takes_its_place_where_that_is_applied) {
  TEST_ASSERT_EQUAL_UINT32(0, now->write(0x0100, {0, 6}));
  TEST_ASSERT_EQUAL_UINT32(0, now->write_single(0x0130, 1));
  now->step(5);
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0011));
  save();
  start_accepting();
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0131));
}

TEST_F(Refused, defaults_drop_it) {
  TEST_ASSERT_EQUAL_UINT32(0, now->command(kDefaults));
  TEST_ASSERT_EQUAL_UINT32(kDone, now->result());
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0011));
  save();
  start_accepting();
  TEST_ASSERT_EQUAL_UINT32(0, now->get(0x0131));
}

// As the tuner gives it to the axis and takes it back.
TEST_F(Refused, a_tuning_takes_its_place_until_it_is_undone) {
  firmware::Parameters parameters = {};
  firmware::ShaperSettings shaper = {};
  Axis<firmware::kLineCapacity>& axis = now->axis;
  parameters.load_defaults();
  shaper.begin(axis, parameters, {});
  for (const uint32_t set : {uint32_t{0}, uint32_t{shaper.kSetInForce}}) {
    shaper.stage(set, firmware::Register::kModeCount, 1);
    shaper.stage(set, firmware::mode_register(0, firmware::ModeField::kFrequency), 5000);
    shaper.stage(set, firmware::mode_register(0, firmware::ModeField::kKind), 2);
  }
  shaper.restore(0);
  for (int i = 0; i < 5; ++i) shaper.service();
  Mode modes[firmware::kMaxModes];
  const auto is_kept = [&] {
    TEST_ASSERT_TRUE(shaper.restoring());
    TEST_ASSERT_EQUAL_UINT32(0, shaper.modes_in_force(modes));
    TEST_ASSERT_EQUAL_UINT32(0, parameters.get(firmware::Register::kPredictedResidual));
    const auto frequency = firmware::mode_register(0, firmware::ModeField::kFrequency);
    TEST_ASSERT_EQUAL_UINT32(1, shaper.staged(shaper.kSetInForce, firmware::Register::kModeCount));
    TEST_ASSERT_EQUAL_UINT32(5000, shaper.staged(shaper.kSetInForce, frequency));
  };
  is_kept();
  shaper.follow(-1.0);
  TEST_ASSERT_FALSE(shaper.waiting());
  const ShaperSpec spec{ShaperKind::kZv, {11.0, 0.1}, 0.0, 0.0, nullptr};
  shaper.adopt(&spec, 1);
  TEST_ASSERT_FALSE(shaper.restoring());
  TEST_ASSERT_EQUAL_UINT32(1, shaper.modes_in_force(modes));
  shaper.give_back();
  is_kept();
  // It is not taken for the design that runs.
  shaper.request_apply(Retune::kAtRest);
  shaper.service();
  shaper.service();
  TEST_ASSERT_EQUAL_UINT32(3, parameters.get(firmware::Register::kShaperState));
}

}  // namespace
