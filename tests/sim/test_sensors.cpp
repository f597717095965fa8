// SPDX-License-Identifier: Apache-2.0
// Encoder, accelerometer and their noise; the drive they sit in.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/plant/accelerometer.hpp"
#include "sim/plant/encoder.hpp"
#include "sim/plant/noise.hpp"
#include "sim/simulated_drive.hpp"
#include "tests/support/test.hpp"

using stillpoint::kSignalPerCount;
using stillpoint::Signal;
using stillpoint::signal_from_counts;
using stillpoint::sim::Accelerometer;
using stillpoint::sim::Arm;
using stillpoint::sim::Encoder;
using stillpoint::sim::EncoderConfig;
using stillpoint::sim::Noise;
using stillpoint::sim::SimulatedDrive;
using stillpoint::sim::SimulatedDriveConfig;
using stillpoint::testing::Random;

TEST_HOST(an_encoder_reads_the_nearest_line) {
  Random random(7);
  for (const int64_t resolution : {int64_t{1}, int64_t{3}, kSignalPerCount / 4, kSignalPerCount, 7 * kSignalPerCount}) {
    Encoder encoder({resolution, 0.0, 1});
    for (int i = 0; i < 1000; ++i) {
      const Signal motor = random.integer(-1000000 * kSignalPerCount, 1000000 * kSignalPerCount);
      const Signal read = encoder.read(motor);
      TEST_ASSERT_EQUAL_INT64(0, read % resolution);
      TEST_ASSERT_AT_MOST_INT64(resolution / 2, read > motor ? read - motor : motor - read);
    }
  }
}

TEST_HOST(an_encoder_stays_in_the_range_of_positions) {
  Encoder encoder({7 * kSignalPerCount, 1000.0, 3});
  for (int i = 0; i < 1000; ++i) {
    TEST_ASSERT_AT_LEAST_INT64(signal_from_counts(INT32_MAX) - 10000 * kSignalPerCount,
                               encoder.read(signal_from_counts(INT32_MAX)));
    TEST_ASSERT_AT_MOST_INT64(signal_from_counts(INT32_MIN) + 10000 * kSignalPerCount,
                              encoder.read(signal_from_counts(INT32_MIN)));
  }
}

TEST_HOST(noise_has_the_deviation_asked_for_and_comes_again_from_its_seed) {
  constexpr int kSamples = 200000;
  Noise noise(2.5, 11);
  Noise again(2.5, 11);
  Noise other(2.5, 12);
  double sum = 0.0;
  double squares = 0.0;
  double fourths = 0.0;
  double with_other = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double value = noise.next();
    TEST_ASSERT_TRUE(value == again.next());
    sum += value;
    squares += value * value;
    fourths += value * value * value * value;
    with_other += value * other.next();
  }
  const double variance = squares / kSamples;
  // Five standard errors of each estimate.
  TEST_ASSERT_DOUBLE_WITHIN(5.0 * 2.5 / std::sqrt(kSamples), 0.0, sum / kSamples);
  TEST_ASSERT_DOUBLE_RELATIVE(5.0 * std::sqrt(2.0 / kSamples), 6.25, variance);
  TEST_ASSERT_DOUBLE_WITHIN(5.0 * std::sqrt(24.0 / kSamples), 3.0, fourths / kSamples / (variance * variance));
  TEST_ASSERT_DOUBLE_WITHIN(5.0 * 6.25 / std::sqrt(kSamples), 0.0, with_other / kSamples);
}

TEST_HOST(noise_of_no_deviation_is_silence) {
  Noise noise(0.0, 1);
  for (int i = 0; i < 10; ++i) TEST_ASSERT_TRUE(noise.next() == 0.0);
}

TEST_HOST(an_accelerometer_reads_raw_steps_and_saturates) {
  Accelerometer accelerometer({0.01, 50.0, 0.0, 1});
  TEST_ASSERT_EQUAL_INT32(1234, accelerometer.read(12.34));
  TEST_ASSERT_EQUAL_INT32(-1234, accelerometer.read(-12.3449));
  TEST_ASSERT_EQUAL_INT32(5000, accelerometer.read(1e9));
  TEST_ASSERT_EQUAL_INT32(-5000, accelerometer.read(-1e9));
}

TEST_HOST(sensors_refuse_what_cannot_be) {
  REQUIRE_THROWS_AS(Encoder(EncoderConfig{0, 0.0, 1}), std::invalid_argument);
  REQUIRE_THROWS_AS(Encoder(EncoderConfig{1, -1.0, 1}), std::invalid_argument);
  REQUIRE_THROWS_AS(Accelerometer({0.0, 1.0, 0.0, 1}), std::invalid_argument);
  REQUIRE_THROWS_AS(Accelerometer({1.0, 1.0, std::nan(""), 1}), std::invalid_argument);
}

namespace {

struct Drive {
  SimulatedDrive drive{config()};

  static SimulatedDriveConfig config() {
    SimulatedDriveConfig config;
    config.modes = {{{11.0, 0.11}, 1.0}};
    config.start = signal_from_counts(1000);
    return config;
  }
};

}  // namespace

TEST_F(Drive, a_drive_that_is_enabled_follows_the_setpoint_exactly) {
  const Signal setpoint = signal_from_counts(1000) + 12345;
  const stillpoint::hal::ServoFeedback feedback = drive.exchange({setpoint, true});
  TEST_ASSERT_EQUAL_INT64(setpoint, feedback.position);
  TEST_ASSERT_EQUAL_INT64(setpoint, drive.motor());
}

TEST_F(Drive, a_drive_that_is_not_enabled_stands) {
  const stillpoint::hal::ServoFeedback feedback = drive.exchange({signal_from_counts(5000), false});
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1000), feedback.position);
  TEST_ASSERT_TRUE(drive.tip_acceleration() == 0.0);
}

TEST_F(Drive, feedback_counts_its_sequence_and_says_what_was_staged) {
  TEST_ASSERT_EQUAL_INT32(1, drive.exchange({0, false}).sequence);
  TEST_ASSERT_EQUAL_INT32(2, drive.exchange({0, false}).sequence);
  drive.skip_sequence(3);
  drive.set_valid(false);
  drive.set_commit(false);
  const stillpoint::hal::ServoFeedback feedback = drive.exchange({0, false});
  TEST_ASSERT_EQUAL_INT32(6, feedback.sequence);
  TEST_ASSERT_FALSE(feedback.valid || feedback.commit);
}

TEST_HOST(an_arm_shakes_its_motor_by_its_reaction_and_the_encoder_sees_it) {
  SimulatedDriveConfig config = Drive::config();
  config.start = 0;
  config.modes = {{{11.0, 0.02}, 0.9}, {{31.0, 0.01}, 0.1}};
  SimulatedDrive stiff(config);
  config.reaction = 0.03;
  SimulatedDrive soft(config);
  Arm arm(config.modes, config.tick_s);
  double rocked = 0.0;
  for (int i = 1; i <= 2000; ++i) {
    // 0.2 s at one velocity, then standing.
    const int32_t counts = 500 * std::min(i, 200);
    arm.step(i <= 200 ? 500e-6 : 0.0);
    const double followed = 1e-6 * counts;
    const Signal read = soft.exchange({signal_from_counts(counts), true}).position;
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(counts), stiff.exchange({signal_from_counts(counts), true}).position);
    TEST_ASSERT_EQUAL_INT64(read, soft.motor());
    const double given_way = 1e-6 * static_cast<double>(read - signal_from_counts(counts)) / kSignalPerCount;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.03 * arm.deflection(), given_way);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, followed + arm.deflection(), soft.tip_position());
    TEST_ASSERT_TRUE(soft.tip_position() == stiff.tip_position() && soft.tip_velocity() == stiff.tip_velocity());
    if (i > 200) rocked = std::max(rocked, std::abs(given_way));
  }
  TEST_ASSERT_TRUE(rocked > 1e-4);
}

TEST_HOST(a_drive_refuses_a_reaction_that_no_servo_has) {
  SimulatedDriveConfig config = Drive::config();
  for (const double reaction : {-0.1, 1.0, std::nan("")}) {
    config.reaction = reaction;
    REQUIRE_THROWS_AS(SimulatedDrive{config}, std::invalid_argument);
  }
}

TEST_HOST(a_jump_over_the_whole_range_of_positions_is_felt_in_full) {
  SimulatedDriveConfig config = Drive::config();
  config.start = signal_from_counts(INT32_MIN);
  SimulatedDrive drive(config);
  static_cast<void>(drive.exchange({signal_from_counts(INT32_MAX), true}));
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(INT32_MAX), drive.motor());
  // 2^32 counts are 4295 units; the tip has hardly moved from the lower end yet.
  TEST_ASSERT_DOUBLE_RELATIVE(1e-2, -4294.967295, drive.arm().deflection());
}
