// SPDX-License-Identifier: Apache-2.0
#include "firmware/pulse_train.hpp"

#include <algorithm>

#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;

namespace {

__extension__ using Exact = __int128;

constexpr PulseConfig kConfig{1, 1, 168000000, 200000, 1000000, 2500, 5000, 1000, 4000, 256, 0, false};
constexpr int64_t kWindowCycles = 168000 - 168 - 672 - 1;  // tick - hold - jitter, rounded down
constexpr int64_t kSetupCycles = 840;
constexpr int64_t kWidthCycles = 420;
constexpr int64_t kShortestCycles = 840;  // both of twice the width and 200 kHz

// floor(a / b), b > 0
Exact floored(Exact a, Exact b) { return a / b - (a % b < 0 ? 1 : 0); }

// The train under test, the drive that counts its pulses, and where both should be, without any wrap.
struct Counted {
  PulseTrain train;
  PulseConfig config = kConfig;
  Exact setpoint = 0;  // since align
  Exact sent = 0;
  int64_t last_sign = 0;  // of the newest pulse
  PulseBurst newest = {};
  Signal wrapped = 0;

  void begin(const PulseConfig& how, Signal at = 0) {
    config = how;
    PulseTiming timing{};
    TEST_ASSERT_OK(plan_pulses(how, timing));
    train.use(timing);
    train.align(at);
    wrapped = at;
    setpoint = sent = 0;
    last_sign = 0;
  }
  int64_t sign() const { return newest.forward ? 1 : -1; }
  void go(int64_t lsb) {
    setpoint += lsb;
    wrapped = wrapping_sum(wrapped, lsb);
    newest = train.next(wrapped);
    sent += sign() * int64_t{newest.count};
    if (newest.count != 0) last_sign = sign();
    check_shape();
  }
  void check_shape() const {
    const int64_t count = newest.count;
    if (count == 0) return;
    const int64_t period = newest.period_cycles;
    TEST_ASSERT_AT_MOST_INT64(kWindowCycles, count * period);
    TEST_ASSERT_AT_LEAST_INT64(kWindowCycles + 1, count * (period + 1));
    TEST_ASSERT_AT_LEAST_INT64(kWidthCycles, period / 2);
    TEST_ASSERT_AT_LEAST_INT64(kShortestCycles, period);
    if (newest.reversed) TEST_ASSERT_AT_LEAST_INT64(kSetupCycles, period - period / 2);
  }
  Exact pulse() const { return Exact{config.counts} << 32; }
  Exact owed() const { return setpoint * config.pulses - sent * pulse(); }
  Exact rounded() const { return floored(setpoint * config.pulses + pulse() / 2, pulse()); }
  bool exact() const { return sent == rounded(); }
};

// At most `most` pulses a tick, as a part of a count to many counts.
int64_t random_step(testing::Random& random, const PulseConfig& config, double most) {
  const double lsb = most * 4294967296.0 * config.counts / config.pulses;
  const double scale = random.unit() < 0.3 ? 1e-3 : 1.0;
  return static_cast<int64_t>(lsb * scale * random.between(-1.0, 1.0));
}

PulseConfig random_ratio(testing::Random& random) {
  PulseConfig config = kConfig;
  if (random.unit() < 0.2) return config;
  const int64_t most = random.unit() < 0.5 ? 100 : INT32_MAX;
  config.pulses = static_cast<uint32_t>(random.integer(1, most));
  // Steps of tens of pulses are to fit into 2^31 counts.
  config.counts =
      static_cast<uint32_t>(random.integer(1, std::min<int64_t>(INT32_MAX, 1000000 * int64_t{config.pulses})));
  return config;
}

}  // namespace

TEST_F(Counted, the_pulses_sum_to_the_rounded_setpoint_at_every_tick) {
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    TEST_INFO("seed", seed);
    testing::Random random(seed);
    PulseConfig how = random_ratio(random);
    how.without_reversal_gap = true;
    begin(how, static_cast<Signal>(random.next()));
    for (int tick = 0; tick < 500; ++tick) {
      go(random_step(random, config, 90.0));  // what fits into a reversal, too
      TEST_ASSERT_TRUE(exact());
    }
    TEST_ASSERT_EQUAL_UINT32(0, train.limited_ticks());
  }
}

TEST_F(Counted, only_against_the_last_pulse_is_the_error_above_half_a_pulse_and_below_one) {
  uint32_t held = 0;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    TEST_INFO("seed", seed);
    testing::Random random(seed);
    begin(random_ratio(random));
    for (int tick = 0; tick < 500; ++tick) {
      go(random_step(random, config, random.unit() < 0.5 ? 90.0 : 1.0));
      if (exact()) continue;
      ++held;
      TEST_ASSERT_EQUAL_UINT32(0, newest.count);
      TEST_ASSERT_TRUE(owed() * last_sign < 0);
      TEST_ASSERT_TRUE(owed() < pulse() && -owed() < pulse());
    }
  }
  TEST_ASSERT_AT_LEAST_INT64(1000, held);
}

TEST_F(Counted, a_dither_around_an_edge_of_the_rounding_moves_nothing) {
  begin(kConfig);
  const int64_t half = kSignalPerCount / 2;
  go(10 * kSignalPerCount + half);  // forward to the edge: the eleventh pulse has been sent
  TEST_ASSERT_EQUAL_INT64(11, static_cast<int64_t>(sent));
  for (int tick = 0; tick < 1000; ++tick) {
    go(tick % 2 == 0 ? -1 : 1);  // an LSB across the edge
    TEST_ASSERT_EQUAL_UINT32(0, newest.count);
  }
  // Nearly a whole pulse, peak to peak, from the edge.
  go(-half + 1);
  TEST_ASSERT_EQUAL_UINT32(0, newest.count);
  go(half - 1);
  TEST_ASSERT_EQUAL_UINT32(0, newest.count);
}

TEST_F(Counted, the_same_dither_chatters_without_the_gap) {
  PulseConfig how = kConfig;
  how.without_reversal_gap = true;
  begin(how);
  go(kSignalPerCount / 2);
  for (int tick = 0; tick < 10; ++tick) {
    go(tick % 2 == 0 ? -1 : 1);
    TEST_ASSERT_EQUAL_UINT32(1, newest.count);
  }
}

TEST_F(Counted, a_drive_that_is_brought_to_a_whole_pulse_ends_on_it_from_either_side) {
  begin(kConfig);
  go(50 * kSignalPerCount);
  TEST_ASSERT_TRUE(exact());
  go(3 * kSignalPerCount + kSignalPerCount / 2);
  go(-3 * kSignalPerCount - kSignalPerCount / 2);
  TEST_ASSERT_TRUE(owed() == 0);
  go(-kSignalPerCount);
  TEST_ASSERT_TRUE(owed() == 0);
  go(0);
  TEST_ASSERT_EQUAL_UINT32(0, newest.count);
}

TEST_F(Counted, what_does_not_fit_into_a_tick_waits_and_is_counted) {
  testing::Random random(7);
  begin(kConfig);
  const auto most = static_cast<uint32_t>(kWindowCycles / kShortestCycles);  // 198, below the hardware's 256
  for (int run = 0; run < 100; ++run) {
    const uint32_t before = train.limited_ticks();
    uint32_t limited = 0;
    go(random.integer(-20000, 20000) * kSignalPerCount);
    while (!exact()) {
      ++limited;
      TEST_ASSERT_AT_MOST_INT64(200, limited);
      go(0);
      TEST_ASSERT_AT_MOST_INT64(most, newest.count);
    }
    TEST_ASSERT_EQUAL_UINT32(limited, train.limited_ticks() - before);
  }
  TEST_ASSERT_AT_LEAST_INT64(1000, train.limited_ticks());
}

TEST_F(Counted, a_backlog_of_the_whole_range_loses_nothing) {
  PulseConfig how = kConfig;
  how.pulses = INT32_MAX;
  begin(how);
  // Ever further ahead by nearly half the range, then back.
  for (int tick = 0; tick < 100; ++tick) go(INT64_MAX);
  TEST_ASSERT_EQUAL_UINT32(198, newest.count);
  TEST_ASSERT_EQUAL_UINT32(100, train.limited_ticks());
  for (int tick = 0; tick < 100; ++tick) go(-INT64_MAX);
  for (int tick = 0; tick < 1000 && !exact(); ++tick) go(0);
  TEST_ASSERT_TRUE(exact());
}

TEST_F(Counted, leftovers_in_a_row_are_a_fault_where_that_is_configured) {
  PulseConfig how = kConfig;
  how.fault_after = 3;
  begin(how);
  go(480 * kSignalPerCount);
  go(0);
  TEST_ASSERT_EQUAL_UINT32(2, train.limited_ticks());
  TEST_ASSERT_FALSE(train.faulted());
  go(0);
  TEST_ASSERT_TRUE(exact());
  go(900 * kSignalPerCount);
  for (int tick = 0; tick < 2; ++tick) {
    TEST_ASSERT_FALSE(train.faulted());
    go(0);
  }
  TEST_ASSERT_TRUE(train.faulted());
  go(0);
  go(0);
  TEST_ASSERT_TRUE(exact());
  TEST_ASSERT_FALSE(train.faulted());
}

TEST_F(Counted, a_reversal_leaves_room_for_the_set_up_time_and_carries_the_rest) {
  begin(kConfig);
  go(50 * kSignalPerCount);
  go(-150 * kSignalPerCount);
  TEST_ASSERT_TRUE(newest.reversed);
  TEST_ASSERT_EQUAL_UINT32(kWindowCycles / (2 * kSetupCycles), newest.count);
  go(0);
  TEST_ASSERT_FALSE(newest.reversed);
  TEST_ASSERT_TRUE(exact());
}

TEST_F(Counted, what_is_given_back_comes_with_the_next_tick_and_the_old_direction_stays) {
  begin(kConfig);
  go(20 * kSignalPerCount);
  go(-5 * kSignalPerCount);
  TEST_ASSERT_TRUE(newest.reversed);
  train.give_back(newest);
  sent += newest.count;
  go(-kSignalPerCount);
  TEST_ASSERT_EQUAL_UINT32(6, newest.count);
  TEST_ASSERT_TRUE(newest.reversed);
  TEST_ASSERT_TRUE(exact());
}

TEST_F(Counted, positions_wrap) {
  begin(kConfig, INT64_MAX - 10);
  go(3 * kSignalPerCount);
  TEST_ASSERT_TRUE(wrapped < 0);
  TEST_ASSERT_EQUAL_UINT32(3, newest.count);
  TEST_ASSERT_TRUE(newest.forward);
  go(-3 * kSignalPerCount);
  TEST_ASSERT_EQUAL_UINT32(3, newest.count);
  TEST_ASSERT_FALSE(newest.forward);
}

TEST_F(Counted, standing_still_sends_nothing_and_aligning_forgets) {
  begin(kConfig);
  go(INT64_C(5000) * kSignalPerCount);
  train.align(wrapped);
  TEST_ASSERT_EQUAL_UINT32(0, train.next(wrapped).count);
  const Signal elsewhere = wrapping_sum(wrapped, 123456789);
  train.align(elsewhere);
  for (int tick = 0; tick < 100; ++tick) TEST_ASSERT_EQUAL_UINT32(0, train.next(elsewhere).count);
}

TEST(an_unconfigured_train_sends_nothing) {
  static PulseTrain train;
  TEST_ASSERT_EQUAL_UINT32(0, train.next(INT64_MAX).count);
  TEST_ASSERT_EQUAL_UINT32(0, train.next(INT64_MIN).count);
}

// The same at compile time and at run time.
constexpr PulseTiming compiled() {
  PulseTiming timing{};
  static_cast<void>(plan_pulses(kConfig, timing));
  return timing;
}
static_assert(compiled().most == 198 && compiled().most_reversing == 99 && compiled().window_cycles == kWindowCycles);

TEST(a_bad_configuration_is_refused_by_name_and_the_old_timing_stays) {
  const auto with = [](uint32_t PulseConfig::*what, uint32_t value) {
    PulseConfig config = kConfig;
    config.*what = value;
    return config;
  };
  PulseTiming timing{};
  TEST_ASSERT_OK(plan_pulses(kConfig, timing));
  TEST_ASSERT_REFUSED(kBelowMinimum, kGearRatio, plan_pulses(with(&PulseConfig::pulses, 0), timing));
  TEST_ASSERT_REFUSED(kAboveMaximum, kGearRatio, plan_pulses(with(&PulseConfig::counts, 0x80000000U), timing));
  TEST_ASSERT_REFUSED(kBelowMinimum, kFrequency, plan_pulses(with(&PulseConfig::clock_hz, 0), timing));
  TEST_ASSERT_REFUSED(kAboveMaximum, kFrequency, plan_pulses(with(&PulseConfig::max_frequency_hz, 168000001), timing));
  TEST_ASSERT_REFUSED(kAboveMaximum, kTick, plan_pulses(with(&PulseConfig::tick_ns, 1000000001), timing));
  TEST_ASSERT_REFUSED(kBelowMinimum, kDuration, plan_pulses(with(&PulseConfig::width_ns, 0), timing));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDuration, plan_pulses(with(&PulseConfig::setup_ns, UINT32_MAX), timing));
  TEST_ASSERT_REFUSED(kAboveMaximum, kSamples, plan_pulses(with(&PulseConfig::most_pulses, 1024), timing));
  TEST_ASSERT_REFUSED(kBelowMinimum, kTick, plan_pulses(with(&PulseConfig::setup_ns, 600000), timing));
  TEST_ASSERT_EQUAL_UINT32(198, timing.most);
  TEST_ASSERT_EQUAL_UINT32(99, timing.most_reversing);
}

TEST(the_least_tick_named_by_a_refusal_is_taken_and_a_microsecond_less_is_not) {
  PulseConfig config = kConfig;
  config.setup_ns = 600000;
  PulseTiming timing{};
  const Status status = plan_pulses(config, timing);
  TEST_ASSERT_REFUSED(kBelowMinimum, kTick, status);
  config.tick_ns = static_cast<uint32_t>(status.accepted);
  TEST_ASSERT_OK(plan_pulses(config, timing));
  config.tick_ns -= 1000;
  TEST_ASSERT_REFUSED(kBelowMinimum, kTick, plan_pulses(config, timing));
}
