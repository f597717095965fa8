// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/hardware_limits.hpp"

#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

// Profiles, "calculation of the limits"; the pitch as in the errata.
Hardware lectures_stage() {
  Hardware hardware{};
  hardware.motor_rpm = 12000.0;
  hardware.gear_ratio = 2.0;
  hardware.pitch_m = 0.01;
  hardware.pulses_per_rev = 4000.0;
  hardware.torque_constant = 0.1;
  hardware.max_current_a = 2.5;
  hardware.gear_efficiency = 0.5;
  hardware.screw_efficiency = 0.7;
  hardware.friction_force_n = 10.0;
  hardware.mass_kg = 10.0;
  return hardware;
}

HardwareLimits limits_of(const Hardware& hardware) {
  HardwareLimits limits{};
  TEST_ASSERT_OK(hardware_limits(hardware, limits));
  return limits;
}

}  // namespace

TEST(the_lectures_stage_goes_a_metre_a_second_and_accelerates_with_one_g) {
  const HardwareLimits limits = limits_of(lectures_stage());
  TEST_ASSERT_EQUAL_ENUM(HardwareLimit::kMotor, limits.velocity.binding().by);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, limits.velocity.binding().value);
  TEST_ASSERT_EQUAL_ENUM(HardwareLimit::kForce, limits.acceleration.binding().by);
  TEST_ASSERT_DOUBLE_WITHIN(5e-3, 10.0, limits.acceleration.binding().value);  // 109.96 N - 10 N over 10 kg
}

TEST(its_encoder_and_counter_bind_below_800_kHz_and_3_2_MHz) {
  Hardware hardware = lectures_stage();
  hardware.encoder_max_hz = 800e3;
  hardware.counter_max_hz = 3.2e6;
  HardwareLimits limits = limits_of(hardware);
  for (size_t i = 0; i < limits.velocity.count; ++i)
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, limits.velocity.parts[i].value);
  hardware.counter_max_hz = 1.6e6;
  limits = limits_of(hardware);
  TEST_ASSERT_EQUAL_ENUM(HardwareLimit::kCounter, limits.velocity.binding().by);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5, limits.velocity.binding().value);
  // Ten times finer pulses come ten times as often; the interpolator sees those of the head.
  hardware.interpolation = 10.0;
  hardware.interpolator_max_hz = 200e3;
  limits = limits_of(hardware);
  TEST_ASSERT_EQUAL_ENUM(HardwareLimit::kCounter, limits.velocity.binding().by);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.05, limits.velocity.binding().value);
  hardware.counter_max_hz = 0.0;
  limits = limits_of(hardware);
  TEST_ASSERT_EQUAL_ENUM(HardwareLimit::kInterpolator, limits.velocity.binding().by);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25, limits.velocity.binding().value);
}

TEST(the_lectures_linear_motor_reaches_50) {
  Hardware hardware{};
  hardware.force_constant = 10.0;
  hardware.max_current_a = 5.0;
  hardware.mass_kg = 1.0;
  const HardwareLimits limits = limits_of(hardware);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 50.0, limits.acceleration.binding().value);
  TEST_ASSERT_EQUAL_ENUM(HardwareLimit::kNone, limits.velocity.binding().by);
}

TEST(the_following_error_stays_in_its_bound_for_both_limits_together) {
  const uint64_t seed = 12;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 500; ++i) {
    TEST_INFO("case", i);
    Hardware hardware = lectures_stage();
    hardware.velocity_error_constant = random.between(5.0, 500.0);
    hardware.acceleration_error_constant = random.between(100.0, 1e5);
    hardware.max_following_error_m = random.between(1e-5, 0.1);
    const HardwareLimits limits = limits_of(hardware);
    const double velocity = limits.velocity.binding().value;
    const double acceleration = limits.acceleration.binding().value;
    TEST_ASSERT_AT_LEAST_DOUBLE(1e-12, velocity);
    TEST_ASSERT_AT_LEAST_DOUBLE(1e-12, acceleration);
    const double error =
        velocity / hardware.velocity_error_constant + acceleration / hardware.acceleration_error_constant;
    TEST_ASSERT_AT_MOST_DOUBLE(hardware.max_following_error_m * (1.0 + 1e-12), error);
    // Nothing is given away: either a part of the hardware binds both, or the bound is used up.
    const bool by_hardware = limits.velocity.binding().by != HardwareLimit::kFollowingError &&
                             limits.acceleration.binding().by != HardwareLimit::kFollowingError;
    if (!by_hardware) TEST_ASSERT_AT_LEAST_DOUBLE(hardware.max_following_error_m * (1.0 - 1e-12), error);
  }
}

TEST(the_advised_jerk_is_the_acceleration_over_the_slowest_parts_time) {
  Hardware hardware = lectures_stage();
  hardware.current_bandwidth_hz = 1000.0;
  hardware.electrical_time_s = 1e-3;
  hardware.control_rate_hz = 1000.0;
  HardwareLimits limits = limits_of(hardware);
  TEST_ASSERT_EQUAL_ENUM(HardwareLimit::kControlRate, limits.jerk.binding().by);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, limits.acceleration.binding().value / 2e-3, limits.jerk.binding().value);
  // 24 V through 8 ohm carry 2.5 A after tau ln(6).
  hardware.supply_voltage = 24.0;
  hardware.resistance_ohm = 8.0;
  hardware.control_rate_hz = 0.0;
  limits = limits_of(hardware);
  TEST_ASSERT_EQUAL_ENUM(HardwareLimit::kSupplyVoltage, limits.jerk.binding().by);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, limits.acceleration.binding().value / 1.791759469228055e-3,
                              limits.jerk.binding().value);
}

TEST(bad_hardware_is_refused_by_name_and_leaves_the_limits_alone) {
  HardwareLimits limits{};
  limits.velocity.count = 3;
  Hardware hardware = lectures_stage();
  hardware.mass_kg = -1.0;
  TEST_ASSERT_REFUSED(kBelowMinimum, kMass, hardware_limits(hardware, limits));
  hardware = lectures_stage();
  hardware.pitch_m = __builtin_nan("");
  TEST_ASSERT_REFUSED(kNotFinite, kPitch, hardware_limits(hardware, limits));
  hardware = lectures_stage();
  hardware.screw_efficiency = 1.2;
  TEST_ASSERT_REFUSED(kAboveMaximum, kEfficiency, hardware_limits(hardware, limits));
  hardware = lectures_stage();
  hardware.force_constant = 5.0;
  TEST_ASSERT_REFUSED(kAboveMaximum, kMotorConstant, hardware_limits(hardware, limits));
  hardware = lectures_stage();
  hardware.friction_force_n = 200.0;
  const Status status = hardware_limits(hardware, limits);
  TEST_ASSERT_REFUSED(kAboveMaximum, kFriction, status);
  TEST_ASSERT_DOUBLE_WITHIN(0.01, 109.96, status.accepted);
  TEST_ASSERT_EQUAL_UINT32(3, limits.velocity.count);
}
