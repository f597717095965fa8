// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/excitation.hpp"

#include "shaper/base/math.hpp"
#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

namespace {

using namespace stillpoint;

constexpr double kCount = static_cast<double>(kSignalPerCount);

ExcitationConfig plain(ExcitationKind kind) { return {kind, 0.001, 1000.0, 2000.0, 1e5, 1e7, 1e9, 5.0, 60.0, 4}; }

// Three ticks of rest before and after belong to it.
Announcement peaks_of(Excitation& excitation, double tick, uint64_t& hash, Signal& last) {
  Announcement seen = {};
  Signal past[3] = {};
  uint32_t ticks = 0;
  excitation.start();
  while (!excitation.over()) {
    const Signal now = excitation.tick();
    const double values[] = {math::abs(static_cast<double>(now)), math::abs(static_cast<double>(now - past[0])),
                             math::abs(static_cast<double>(now - 2 * past[0] + past[1])),
                             math::abs(static_cast<double>((now - past[2]) - 3 * (past[0] - past[1])))};
    if (values[0] / kCount > seen.travel) seen.travel = values[0] / kCount;
    if (values[1] / kCount / tick > seen.velocity) seen.velocity = values[1] / kCount / tick;
    const double second = values[2] / kCount / (tick * tick);
    if (second > seen.acceleration) seen.acceleration = second;
    const double third = values[3] / kCount / (tick * tick * tick);
    if (third > seen.jerk) seen.jerk = third;
    past[2] = past[1];
    past[1] = past[0];
    past[0] = now;
    hash = (hash ^ static_cast<uint64_t>(now)) * UINT64_C(0x100000001B3);
    last = now;
    ++ticks;
  }
  seen.duration_s = ticks * tick;
  return seen;
}

void check(const ExcitationConfig& config, const Announcement& announced, Excitation& excitation) {
  uint64_t hash = 0;
  Signal last = 1;
  const Announcement seen = peaks_of(excitation, config.tick_s, hash, last);
  TEST_ASSERT_EQUAL_INT64(0, last);
  TEST_ASSERT_TRUE(seen.travel <= config.amplitude);
  TEST_ASSERT_TRUE(seen.velocity <= config.velocity);
  TEST_ASSERT_TRUE(seen.acceleration <= config.acceleration);
  TEST_ASSERT_TRUE(seen.jerk <= config.jerk);
  const double pairs[][2] = {{seen.travel, announced.travel},
                             {seen.velocity, announced.velocity},
                             {seen.acceleration, announced.acceleration},
                             {seen.jerk, announced.jerk},
                             {seen.duration_s, announced.duration_s}};
  // Of what a chirp of long periods holds only the end is run: its travel is the amplitude.
  const double near[] = {config.kind == ExcitationKind::kChirp ? 1e-4 : 1e-9, 1e-9, 1e-9, 1e-9, 1e-9};
  double rounding = 0x1p-26;
  for (size_t i = 0; i < 5; ++i) {
    TEST_INFO("peak", i);
    TEST_ASSERT_TRUE(pairs[i][0] <= pairs[i][1] * (1.0 + 1e-9));
    TEST_ASSERT_TRUE(pairs[i][0] >= (pairs[i][1] - rounding) * (1.0 - near[i]));
    rounding /= config.tick_s;
  }
}

// One that is refused has nothing to check: 0, else 1.
uint32_t check_if_accepted(const ExcitationConfig& config) {
  Excitation excitation = {};
  Announcement announced = {};
  if (!excitation.prepare(config, announced).ok()) return 0;
  check(config, announced, excitation);
  return 1;
}

// Of each kind in turn, at any tick; the amplitude and the lowest frequency between e^0 and e^`most`, and e^`low` and
// e^4.
ExcitationConfig any(uint32_t i, double most, double low, testing::Random& random) {
  ExcitationConfig config = plain(static_cast<ExcitationKind>(i % 3));
  config.tick_s = math::exp(random.between(-9.0, -6.9));
  config.amplitude = math::exp(random.between(0.0, most));
  config.travel = 2.0 * config.amplitude;
  config.low_hz = math::exp(random.between(low, 4.0));
  return config;
}

// Around what the highest frequency takes, either way.
void limit(ExcitationConfig& config, testing::Random& random) {
  const double turn = 6.2831853 * config.high_hz;
  config.velocity = config.amplitude * turn * math::exp(random.between(-3.0, 3.0));
  config.acceleration = config.amplitude * turn * turn * math::exp(random.between(-3.0, 3.0));
  config.jerk = config.amplitude * turn * turn * turn * math::exp(random.between(-3.0, 3.0));
}

TEST(keeps_every_limit_and_what_it_announced) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  testing::Random random(seed);
  uint32_t prepared = 0;
  for (uint32_t i = 0; i < 60; ++i) {
    ExcitationConfig config = any(i, 19.4, -0.69, random);
    config.high_hz = config.low_hz * random.between(1.1, 5.0);
    limit(config, random);
    prepared += check_if_accepted(config);
  }
  TEST_ASSERT_TRUE(prepared >= 45);
}

// From bands that take minutes to those of a few ticks a period, narrow and over three decades.
TEST_HOST(announces_what_is_reached_in_bands_of_any_width) {
  const uint64_t seed = 20261126;
  TEST_INFO("seed", seed);
  testing::Random random(seed);
  uint32_t prepared = 0;
  for (uint32_t i = 0; i < 90; ++i) {
    ExcitationConfig config = any(i, 16.0, -1.5, random);
    config.high_hz = math::lesser(config.low_hz * (1.0 + math::exp(random.between(-5.0, 6.0))), 0.449 / config.tick_s);
    config.steps = static_cast<uint32_t>(random.integer(2, 12));
    limit(config, random);
    TEST_INFO("run", i);
    prepared += check_if_accepted(config);
  }
  TEST_ASSERT_TRUE(prepared >= 60);
}

// There its second difference steps by more than the third reaches anywhere else.
TEST_HOST(a_slow_chirp_announces_the_jerk_where_its_frequency_begins_to_rise) {
  const ExcitationConfig config{ExcitationKind::kChirp, 1.47203e-4, 23.6, 60.0, 1e9, 1e12, 1e15, 0.432749, 1.33610, 0};
  Excitation excitation = {};
  Announcement announced = {};
  TEST_ASSERT_OK(excitation.prepare(config, announced));
  check(config, announced, excitation);
}

// The same bits on every machine.
TEST(emits_what_it_always_has) {
  struct Golden {
    ExcitationKind kind;
    uint64_t hash;
  };
  constexpr Golden kGolden[] = {{ExcitationKind::kBump, UINT64_C(2508509249378033944)},
                                {ExcitationKind::kSteppedSine, UINT64_C(12554489544012160194)},
                                {ExcitationKind::kChirp, UINT64_C(3848679733171271501)}};
  for (const Golden& golden : kGolden) {
    Excitation excitation = {};
    Announcement announced = {};
    TEST_ASSERT_OK(excitation.prepare(plain(golden.kind), announced));
    uint64_t hash = 0;
    Signal last = 1;
    peaks_of(excitation, 0.001, hash, last);
    TEST_INFO("kind", static_cast<int>(golden.kind));
    TEST_ASSERT_EQUAL_UINT64(golden.hash, hash);
  }
}

static_assert(sizeof(Excitation) <= 1600, "the memory an axis lends it");

TEST(refuses_by_name_and_keeps_what_was) {
  Excitation excitation = {};
  Announcement announced = {};
  TEST_ASSERT_TRUE(excitation.over());
  TEST_ASSERT_EQUAL_INT64(0, excitation.tick());
  ExcitationConfig config = plain(ExcitationKind::kBump);
  config.amplitude = 3000.0;
  Status status = excitation.prepare(config, announced);
  TEST_ASSERT_EQUAL_ENUM(Quantity::kAmplitude, status.quantity);
  TEST_ASSERT_TRUE(status.accepted == 2000.0);
  config = plain(ExcitationKind::kChirp);
  config.jerk = 1.0;
  status = excitation.prepare(config, announced);
  TEST_ASSERT_EQUAL_ENUM(Quantity::kJerk, status.quantity);
  config = plain(ExcitationKind::kSteppedSine);
  config.steps = 65;
  status = excitation.prepare(config, announced);
  TEST_ASSERT_EQUAL_ENUM(Quantity::kStages, status.quantity);
  TEST_ASSERT_OK(excitation.prepare(plain(ExcitationKind::kBump), announced));
  excitation.start();
  status = excitation.prepare(plain(ExcitationKind::kBump), announced);
  TEST_ASSERT_EQUAL_ENUM(Error::kBusy, status.error);
}

}  // namespace
