// SPDX-License-Identifier: Apache-2.0
// Tracking is the last in line: whatever else is wanted of the drive goes before it.
#include "firmware/crc32.hpp"
#include "tests/firmware/tracking_rig.hpp"
#include "tests/support/flash_model.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

TEST_F(TrackingRig, the_next_move_ends_a_record_that_is_used_if_it_is_long_enough) {
  Random random(4);
  arm.become({10.6, kArmDamping});
  track(kShow);
  for (int i = 0; i < 6; ++i) move_somewhere(random, 700);  // 250 to 300 ms of rest: three periods
  move_somewhere(random, 650);
  TEST_ASSERT_EQUAL_UINT32(0, used());
  TEST_ASSERT_AT_LEAST_INT64(1, unheard());
  for (int i = 0; i < 6; ++i) move_somewhere(random, 1000);  // four and more
  move_somewhere(random, 1000);
  TEST_ASSERT_AT_LEAST_INT64(4, used());
  TEST_ASSERT_DOUBLE_WITHIN(0.03, 10.6, tracked_hz());
}

// The setpoints are those of a drive that does not track, bit for bit.
TEST(what_leaves_does_not_depend_on_being_followed) {
  TrackingRig off, on;
  on.track(kShow);
  off.track(kOff);  // as long a request
  Random random_off(5), random_on(5);
  for (TrackingRig* rig : {&off, &on}) {
    rig->arm.setpoints.clear();
    rig->arm.become({10.5, kArmDamping});
  }
  for (int i = 0; i < 6; ++i) {
    off.move_somewhere(random_off, 900);
    on.move_somewhere(random_on, 900);
  }
  TEST_ASSERT_TRUE(off.arm.setpoints == on.arm.setpoints);
  TEST_ASSERT_EQUAL_UINT32(0, off.used());
  TEST_ASSERT_AT_LEAST_INT64(2, on.used());
}

TEST_F(TrackingRig, a_tuning_takes_over_at_any_time_and_is_followed_from_then_on) {
  Random random(6);
  track(kShow);
  arm.become({10.5, kArmDamping});
  for (const uint32_t ms : {150U, 450U, 700U, 1200U, 1600U}) {  // in the move, its rest, the record, after it
    TEST_INFO(ms, ms);
    move_somewhere(random, 1600);
    command(at > 0 ? 0 : 200000);
    step(ms);
    for (int i = 0; i < 100 && write_single(0x0200, 1) != 0; ++i) TEST_ASSERT_EQUAL_UINT32(0x8100, get(0x0012));
    for (int i = 0; i < 20000 && drive.tuning().state != TuneState::kProposed; ++i) step();
    TEST_ASSERT_EQUAL_ENUM(TuneState::kProposed, drive.tuning().state);
    TEST_ASSERT_EQUAL_UINT32(3, tune_memory.holder);
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0200, 3));
    for (int i = 0; i < 20000 && drive.tuning().state != TuneState::kKept; ++i) step();
    TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, drive.tuning().state);
    step(2);
    at = static_cast<int32_t>(demand());
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 10.5, tracked_hz());
    TEST_ASSERT_EQUAL_UINT32(get_wide(0x0102), get_wide(0x0260));
    TEST_ASSERT_EQUAL_UINT32(0, used());
    TEST_ASSERT_EQUAL_UINT32(1, tune_memory.holder);
  }
}

// As many reads of the client's line as no poll makes that has nothing long to do.
constexpr uint32_t kLongPoll = 8;

// Time goes on while it looks, and a client's request arrives then.
TEST_F(TrackingRig, a_look_is_given_up_for_a_set_point_and_taken_again) {
  Random random(7);
  track(kShow);
  arm.become({10.7, kArmDamping});
  uint32_t reads = 0;
  uint32_t reads_after = 0;
  bool sent = false;
  move(250000, 900);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, 0));
  line.on_read = [&] {
    ++reads;
    if (reads > kLongPoll && !sent) {
      sent = true;
      send(framed({1, 6, 0x00, 0x40, 0x00, 0x1F}));
    }
    if (sent) ++reads_after;
    if (reads > kLongPoll) {
      drive.tick();
      drive.own_timer_tick();
    }
  };
  for (int i = 0; i < 2000 && !sent; ++i) {
    reads = 0;
    step();
  }
  TEST_ASSERT_TRUE(sent);
  TEST_ASSERT_AT_MOST_INT64(20, reads_after);  // the request's bytes and the silence behind them among it
  line.on_read = nullptr;
  step(3);
  TEST_ASSERT_TRUE(axis.state().phase != AxisPhase::kAtRest);
  step(50);
  const uint32_t heard_of = heard();
  TEST_ASSERT_TRUE(axis.state().phase != AxisPhase::kAtRest);
  TEST_ASSERT_EQUAL_UINT32(1, heard_of);
}

TEST_F(TrackingRig, a_scope_takes_the_memory_and_tracking_comes_back_when_it_is_free) {
  Random random(8);
  track(kShow);
  arm.become({10.7, kArmDamping});
  for (const uint32_t ms : {200U, 600U, 1500U}) {
    TEST_INFO(ms, ms);
    const uint32_t before = heard();
    command(at > 0 ? -200000 : 200000);
    step(ms);
    TEST_ASSERT_TRUE(tune_memory.claim(MemoryHolder::kScope));
    CaptureWord seen[TuneMemory::kSamples];
    for (size_t i = 0; i < TuneMemory::kSamples; ++i) seen[i].raw = tune_memory.record[i].raw = static_cast<int32_t>(i);
    for (int i = 0; i < 2; ++i) move_somewhere(random);
    for (size_t i = 0; i < TuneMemory::kSamples; ++i) TEST_ASSERT_EQUAL_INT32(seen[i].raw, tune_memory.record[i].raw);
    TEST_ASSERT_AT_MOST_INT64(before + 1, heard());
    TEST_ASSERT_TRUE(tune_memory.held_by(MemoryHolder::kScope));
    tune_memory.release(MemoryHolder::kScope);
    for (int i = 0; i < 2; ++i) move_somewhere(random);
    TEST_ASSERT_AT_LEAST_INT64(before + 2, heard());
  }
}

// The record that was running lies where the sine is prepared.
TEST(a_sine_behind_a_scope_moves_as_announced) {
  for (const uint32_t ms : {450U, 550U, 650U}) {
    TEST_INFO(ms, ms);
    TrackingRig rig;
    rig.track(kShow);
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0201, 3));
    TEST_ASSERT_EQUAL_UINT32(0, rig.write(0x0206, {80, 400}));
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0202, 1000));
    rig.move(250000, ms);
    TEST_ASSERT_EQUAL_UINT32(1, rig.tune_memory.holder);
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0300, 1));
    TEST_ASSERT_EQUAL_UINT32(2, rig.tune_memory.holder);
    TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0200, 1));
    TEST_ASSERT_EQUAL_UINT32(3, rig.tune_memory.holder);
    const double announced = rig.get_wide(0x0230);
    rig.arm.setpoints.clear();
    for (int i = 0; i < 60000 && rig.drive.tuning().state == TuneState::kExciting; ++i) rig.step();
    double furthest = 0.0;
    for (const int64_t setpoint : rig.arm.setpoints)
      furthest = std::fmax(furthest, std::fabs(static_cast<double>(setpoint) / static_cast<double>(kCount) - 250000.0));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, announced, furthest);
    TEST_ASSERT_EQUAL_ENUM(Finding::kFound, rig.drive.tuning().identification.finding);
  }
}

TEST_F(TrackingRig, what_the_client_has_staged_is_not_overwritten) {
  Random random(9);
  track(kApply);
  const uint32_t length = axis.shaper().length_ticks();
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0102, 123456));
  arm.become({10.6, kArmDamping});
  for (int i = 0; i < 8; ++i) move_somewhere(random);
  TEST_ASSERT_EQUAL_UINT32(123456, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(length, axis.shaper().length_ticks());
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 3));  // taken back
  for (int i = 0; i < 2; ++i) move_somewhere(random);
  TEST_ASSERT_DOUBLE_WITHIN(500.0, 106000.0, get_wide(0x0102));
  TEST_ASSERT_TRUE(axis.shaper().length_ticks() != length);
}

TEST_F(TrackingRig, a_halt_a_stop_and_switching_off_lose_the_record) {
  track(kShow);
  arm.become({10.6, kArmDamping});
  for (const uint32_t word : {0x010FU, 0x000BU, 0x0007U, 0x0000U}) {
    for (const uint32_t ms : {150U, 700U}) {
      TEST_INFO(word, word);
      command(at > 0 ? -200000 : 200000);
      step(ms);
      control(word);
      step(1500);
      TEST_ASSERT_EQUAL_UINT32(0, heard() + unheard());
      TEST_ASSERT_EQUAL_UINT32(0, tune_memory.holder);
      control(0x06);
      control(0x07);
      control(0x0F);
      at = static_cast<int32_t>(demand());
    }
  }
  move(at > 0 ? -200000 : 200000);
  TEST_ASSERT_EQUAL_UINT32(1, heard());
}

// With a mode in set 1 that is slower than a client may write, as an auto-tune of before can have found it.
struct SlowMemory {
  FlashModel flash;

  SlowMemory() {
    constexpr uint32_t kImage[] = {0x50495053, 0x10008, 0, 0x10100, 1, 0x10102, 2462, 0x10104, 10000, 0x10106, 1};
    uint32_t crc = firmware::kCrc32Initial;
    size_t end = 0;
    for (const uint32_t word : kImage) {
      flash.pages[0][end++] = word;
      crc = firmware::crc32_update(crc, word);
    }
    flash.pages[0][end] = ~crc;
  }
};

struct SlowRig : SlowMemory, TrackingRig {
  SlowRig() : TrackingRig(&flash) { TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, 1)); }
  void apply() {
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    step(50);
    TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  }
};

// As slow as its line holds just now: what is followed would be longer.
TEST_F(SlowRig, a_refused_design_changes_nothing_and_is_not_tried_again) {
  arm.become({0.2405, 0.1});
  apply();
  track(kApply);
  const uint32_t delay = get_wide(0x0134);
  const auto record_a_move = [&] { move(at > 0 ? 0 : 1000000, 40000); };
  for (int i = 0; i < 8; ++i) record_a_move();
  TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.2405, tracked_hz());
  TEST_ASSERT_TRUE(get(0x0251) != 0);
  TEST_ASSERT_EQUAL_UINT32(2462, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0132));
  TEST_ASSERT_EQUAL_UINT32(delay, get_wide(0x0134));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0012));
  apply();  // by the client: it may be asked again
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0251));
}

}  // namespace
