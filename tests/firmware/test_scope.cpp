// SPDX-License-Identifier: Apache-2.0
// The scope through its registers, against a log that the servo's end keeps of every tick.
#include "shaper/base/signal.hpp"
#include "tests/firmware/drive402.hpp"
#include "tests/support/random.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

enum : uint32_t { kStop, kArm, kTrigger };
enum : uint32_t { kByHand, kLevel, kMotion, kFault, kRest };
enum : uint32_t { kIdle, kWaiting, kTriggered, kFull };
constexpr uint16_t kSetpoint = 2, kPosition = 3, kFollowing = 4, kVelocity = 6, kAccelerometer = 8, kFlags = 11;
constexpr uint32_t kNothingToDo = 0x9200, kTuning = 0x9100;
constexpr uint32_t kWords = 2048, kPage = 62;

int32_t whole(int64_t signal) { return static_cast<int32_t>((signal + kCount / 2) >> 32); }

// Lags a tick behind. Its accelerometer reads the number of the tick, so that a sample tells when it was taken.
struct LoggingServo final : hal::ServoPort {
  struct Tick {
    int64_t setpoint;
    int64_t position;
    bool enabled;
  };
  std::vector<Tick> log;
  int64_t next = 0;
  bool valid = true;

  void disable() override {}
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    const auto tick = static_cast<int32_t>(log.size());
    const int64_t position = next;
    if (command.enabled) next = command.setpoint;
    log.push_back({command.setpoint, position, command.enabled});
    return {position, tick, static_cast<uint16_t>(tick), valid, true};
  }
};

struct ServoHolder {
  LoggingServo servo_end;
};

struct ScopeRig : ServoHolder, Drive402 {
  ScopeRig() : Drive402(servo_end) { enable(); }

  uint32_t command(uint32_t what) { return write_single(0x0300, what); }
  uint32_t scope_state() { return get(0x0301); }

  void set_up(uint32_t trigger, uint32_t pre_percent, uint32_t decimation, std::vector<uint16_t> channels) {
    channels.resize(4);
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0302, trigger));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0307, pre_percent));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0308, decimation));
    TEST_ASSERT_EQUAL_UINT32(0, write(0x030A, channels));
  }

  void fill() {
    for (int i = 0; i < 100000 && scope_state() != kFull; ++i) step(100);
    TEST_ASSERT_EQUAL_UINT32(kFull, scope_state());
  }

  std::vector<int32_t> samples(uint32_t channel) {
    std::vector<int32_t> all;
    const uint32_t count = get(0x0310);
    for (uint32_t block = 0; all.size() < count; ++block) {
      TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0311, channel << 8 | block));
      const std::vector<uint16_t> words = read(0x0400, 2 * kPage);
      for (uint32_t i = 0; i < kPage; ++i) {
        const auto value = static_cast<int32_t>(uint32_t{words[2 * i]} << 16 | words[2 * i + 1]);
        if (all.size() < count) {
          all.push_back(value);
        } else {
          TEST_ASSERT_EQUAL_INT64(0, value);  // beyond the last
        }
      }
    }
    return all;
  }

  const LoggingServo::Tick& at(int32_t tick) { return servo_end.log[static_cast<size_t>(tick)]; }
};

TEST_F(ScopeRig, every_sample_is_the_ticks_that_it_says_whatever_the_decimation_and_the_pretrigger) {
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    TEST_INFO("seed", seed);
    const auto decimation = static_cast<uint32_t>(random.integer(1, 7));
    const auto pre = static_cast<uint32_t>(random.integer(0, 99));
    const auto channels = static_cast<uint32_t>(random.integer(1, 4));
    std::vector<uint16_t> shown = {kAccelerometer, kSetpoint, kPosition, kVelocity};
    shown.resize(channels);
    set_up(kByHand, pre, decimation, shown);
    TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
    start_move(seed % 2 == 0 ? 0 : 900000);
    control(0x0F);
    step(static_cast<uint32_t>(random.integer(0, 3000)));
    TEST_ASSERT_EQUAL_UINT32(kWaiting, scope_state());
    const size_t asked_at = servo_end.log.size();
    TEST_ASSERT_EQUAL_UINT32(0, command(kTrigger));
    fill();
    const std::vector<int32_t> ticks = samples(0);
    const uint32_t before = get(0x0309);
    const uint32_t whole_record = kWords / channels;
    TEST_ASSERT_EQUAL_UINT64(whole_record - whole_record * pre / 100, ticks.size() - before);
    TEST_ASSERT_AT_LEAST_INT64(before, whole_record * pre / 100);
    // The request takes up to 20 ticks.
    TEST_ASSERT_AT_LEAST_INT64(static_cast<int64_t>(asked_at), ticks[before]);
    TEST_ASSERT_AT_LEAST_INT64(ticks[before], static_cast<int64_t>(asked_at + 20 + decimation));
    for (size_t n = 1; n < ticks.size(); ++n) TEST_ASSERT_EQUAL_INT64(int64_t{ticks[n - 1]} + decimation, ticks[n]);
    for (uint32_t k = 1; k < channels; ++k) {
      const std::vector<int32_t> values = samples(k);
      for (size_t n = 0; n < ticks.size(); ++n) {
        const LoggingServo::Tick& then = at(ticks[n]);
        const double change = static_cast<double>(then.setpoint - at(ticks[n] - 1).setpoint);
        if (k == 1) TEST_ASSERT_EQUAL_INT64(whole(then.setpoint), values[n]);
        if (k == 2) TEST_ASSERT_EQUAL_INT64(whole(then.position), values[n]);
        if (k == 3) TEST_ASSERT_DOUBLE_WITHIN(1.02, 1000.0 * change / static_cast<double>(kCount), values[n]);
      }
    }
  }
}

TEST_F(ScopeRig, a_level_triggers_at_the_tick_that_crosses_it_on_the_edge_asked_for) {
  const int32_t levels[] = {400000, 123456, -250000};
  for (const int32_t level : levels) {
    for (uint32_t edge = 0; edge < 3; ++edge) {
      TEST_INFO("level", level);
      TEST_INFO("edge", edge);
      set_up(kLevel, 20, 3, {kAccelerometer, kSetpoint});
      TEST_ASSERT_EQUAL_UINT32(0, write(0x0303, {1}));
      TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0304, level));
      TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0306, edge));
      TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
      const size_t armed_at = servo_end.log.size();
      for (const int32_t target : {-500000, 900000, -500000}) {  // crosses it falling, or not; rising; falling
        start_move(target);
        control(0x0F);
        step(3000);
      }
      fill();
      int64_t crossed = 0;
      for (size_t t = armed_at; t < servo_end.log.size() && crossed == 0; ++t) {
        const int32_t last = whole(servo_end.log[t - 1].setpoint), now = whole(servo_end.log[t].setpoint);
        const bool rises = last < level && now >= level, falls = last > level && now <= level;
        if ((rises && edge != 1) || (falls && edge != 0)) crossed = static_cast<int64_t>(t);
      }
      const uint32_t before = get(0x0309);
      const std::vector<int32_t> ticks = samples(0);
      TEST_ASSERT_AT_LEAST_INT64(1, crossed);
      TEST_ASSERT_AT_LEAST_INT64(crossed, ticks[before]);
      TEST_ASSERT_AT_LEAST_INT64(ticks[before - 1] + 1, crossed);
    }
  }
}

TEST_F(ScopeRig, a_motion_triggers_with_its_first_tick) {
  set_up(kMotion, 10, 1, {kAccelerometer, kSetpoint});
  TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
  step(500);
  TEST_ASSERT_EQUAL_UINT32(kWaiting, scope_state());
  start_move(500000);
  fill();
  const uint32_t before = get(0x0309);
  const std::vector<int32_t> values = samples(1);
  TEST_ASSERT_EQUAL_UINT32(102, before);
  for (uint32_t n = 0; n < before; ++n) TEST_ASSERT_EQUAL_INT64(values[0], values[n]);
  const int32_t first = samples(0)[before];
  TEST_ASSERT_EQUAL_INT64(at(first - 2).setpoint, at(first - 1).setpoint);
  TEST_ASSERT_FALSE(at(first + 1).setpoint == at(first - 1).setpoint);
}

TEST_F(ScopeRig, a_rest_triggers_with_the_first_tick_that_stands) {
  for (const uint32_t pre : {0U, 10U}) {
    TEST_INFO("pre", pre);
    set_up(kRest, pre, 1, {kAccelerometer, kSetpoint});
    TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
    step(500);
    TEST_ASSERT_EQUAL_UINT32(kWaiting, scope_state());
    const int32_t target = pre == 0 ? 500000 : 0;
    start_move(target);
    control(0x0F);
    fill();
    const uint32_t before = get(0x0309);
    TEST_ASSERT_EQUAL_UINT32(1024 * pre / 100, before);
    const std::vector<int32_t> values = samples(1);
    for (size_t n = before; n < values.size(); ++n) TEST_ASSERT_EQUAL_INT64(target, values[n]);
    // The setpoint moved last in the tick before.
    const int32_t first = samples(0)[before];
    TEST_ASSERT_EQUAL_INT64(target * kCount, at(first).setpoint);
    TEST_ASSERT_FALSE(at(first - 1).setpoint == at(first - 2).setpoint);
  }
}

TEST_F(ScopeRig, a_fault_triggers_and_what_led_to_it_is_there) {
  set_up(kFault, 50, 1, {kFlags, kFollowing, kAccelerometer});
  TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
  step(1000);
  servo_end.valid = false;
  step(20);
  servo_end.valid = true;
  fill();
  const uint32_t before = get(0x0309);
  const std::vector<int32_t> flags = samples(0);
  TEST_ASSERT_EQUAL_UINT32(kWords / 3 / 2, before);
  TEST_ASSERT_EQUAL_INT64(0, flags[before] & 2);
  TEST_ASSERT_EQUAL_INT64(3, flags[before - 4] & 3);
  TEST_ASSERT_EQUAL_INT64(0, flags.back() & 1);
}

TEST_F(ScopeRig, what_has_no_record_says_so_and_reading_changes_nothing) {
  TEST_ASSERT_EQUAL_UINT32(3, write_single(0x0308, 0));
  TEST_ASSERT_EQUAL_UINT32(6, exception_in(exchange(read_request(0x0400, 2))));
  expect_refused(0x8500, 0x0308);  // the write's still; why there is nothing to read, 0301 says
  TEST_ASSERT_EQUAL_UINT32(1, get_wide(0x0016));
  TEST_ASSERT_EQUAL_UINT32(2, exception_in(exchange(read_request(0x047B, 2))));
  TEST_ASSERT_EQUAL_UINT32(6, command(kTrigger));
  expect_refused(kNothingToDo, 0x0300);
  set_up(kByHand, 0, 1, {kAccelerometer});
  TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
  TEST_ASSERT_EQUAL_UINT32(6, exception_in(exchange(read_request(0x0400, 2))));
  TEST_ASSERT_EQUAL_UINT32(0, command(kTrigger));
  fill();
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0309));
  const std::vector<int32_t> once = samples(0);
  step(5000);
  TEST_ASSERT_TRUE(once == samples(0));
  TEST_ASSERT_EQUAL_UINT64(kWords, once.size());
  TEST_ASSERT_EQUAL_UINT32(0, command(kStop));
  TEST_ASSERT_EQUAL_UINT32(kIdle, scope_state());
  TEST_ASSERT_EQUAL_UINT32(6, exception_in(exchange(read_request(0x0400, 2))));
}

// Function 23 writes before it reads, and must not write what leaves it nothing to read.
TEST_F(ScopeRig, a_request_that_reads_the_record_does_not_begin_another) {
  const auto read_after = [&](uint32_t address, uint32_t word, uint8_t page = 4) {
    Bytes pdu{23, page, 0x00, 0, 2};
    append_word(pdu, address);
    pdu.insert(pdu.end(), {0, 1, 2});
    append_word(pdu, word);
    return exception_in(exchange(pdu));
  };
  set_up(kByHand, 0, 1, {kAccelerometer});
  TEST_ASSERT_EQUAL_UINT32(6, read_after(0x0300, kArm));
  TEST_ASSERT_EQUAL_UINT32(kIdle, scope_state());
  TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
  TEST_ASSERT_EQUAL_UINT32(0, command(kTrigger));
  fill();
  const std::vector<int32_t> once = samples(0);
  for (const uint32_t what : {kArm, kStop}) {
    TEST_ASSERT_EQUAL_UINT32(6, read_after(0x0300, what));
    expect_refused(kNothingToDo, 0x0300);
  }
  TEST_ASSERT_EQUAL_UINT32(6, read_after(0x0200, 1));
  expect_refused(kNothingToDo, 0x0200);
  TEST_ASSERT_EQUAL_UINT32(3, read_after(0x0300, 3));
  TEST_ASSERT_EQUAL_UINT32(2, read_after(0x0301, 1));
  TEST_ASSERT_EQUAL_UINT32(0, read_after(0x0311, 1));
  TEST_ASSERT_EQUAL_UINT32(kFull, scope_state());
  TEST_ASSERT_TRUE(once == samples(0));
  TEST_ASSERT_EQUAL_UINT32(0, read_after(0x0300, kStop, 5));  // which reads the fault history
  TEST_ASSERT_EQUAL_UINT32(kIdle, scope_state());
}

TEST_F(ScopeRig, what_cannot_be_recorded_is_refused_by_name_and_leaves_it_idle) {
  set_up(kLevel, 0, 1, {kAccelerometer, kSetpoint, 0, kPosition});
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0303, 2));  // behind the first 0
  TEST_ASSERT_EQUAL_UINT32(6, command(kArm));
  expect_refused(firmware::reason_of(Error::kAboveMaximum, Quantity::kChannels), 0x0303);
  TEST_ASSERT_EQUAL_UINT32(1, get_wide(0x0016));
  TEST_ASSERT_EQUAL_UINT32(kIdle, scope_state());
  // What was recorded is still there after a refusal.
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0303, 1));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0302, kByHand));
  TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
  TEST_ASSERT_EQUAL_UINT32(0, command(kTrigger));
  fill();
  set_up(kByHand, 0, 1, {});
  TEST_ASSERT_EQUAL_UINT32(6, command(kArm));
  expect_refused(firmware::reason_of(Error::kBelowMinimum, Quantity::kChannels), 0x030A);
  TEST_ASSERT_EQUAL_UINT32(kFull, scope_state());
  TEST_ASSERT_EQUAL_UINT32(3, write_single(0x0308, 0));
  TEST_ASSERT_EQUAL_UINT32(3, write_single(0x0307, 100));
  TEST_ASSERT_EQUAL_UINT32(3, write_single(0x030A, firmware::kScopeSources));
  TEST_ASSERT_EQUAL_UINT32(3, command(3));
}

TEST_F(ScopeRig, a_tuning_takes_the_memory_and_the_scope_waits_until_it_is_over) {
  set_up(kByHand, 0, 1, {kAccelerometer});
  TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
  TEST_ASSERT_EQUAL_UINT32(0, command(kTrigger));
  fill();
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0200, 1));
  TEST_ASSERT_EQUAL_UINT32(kIdle, scope_state());
  TEST_ASSERT_EQUAL_UINT32(6, exception_in(exchange(read_request(0x0400, 2))));
  TEST_ASSERT_EQUAL_UINT32(6, command(kArm));
  expect_refused(kTuning, 0x0300);
  TEST_ASSERT_EQUAL_UINT32(0, command(kStop));
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0200, 2));
  step(20);
  TEST_ASSERT_EQUAL_UINT32(0, command(kArm));
  TEST_ASSERT_EQUAL_UINT32(kWaiting, scope_state());
}

}  // namespace
