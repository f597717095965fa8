// SPDX-License-Identifier: Apache-2.0
// The point of it all, on an arm that this test integrates by its own method: a shaped move leaves a millionth of the
// plain vibration, and the floor that rounding the setpoint to 2^-32 counts puts under it.
#include <cmath>
#include <complex>
#include <vector>

#include "shaper/axis/axis.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

constexpr double kTick = 1e-3;
using Complex = std::complex<long double>;

// The arm x'' + 2 zeta w x' + w^2 x = w^2 u, u held over a tick, as its complex mode: an increment du of the setpoint
// adds -du times a phasor that turns by the pole every tick. Exact, and in increments so that long moves lose nothing.
// Returns the amplitude (counts) that swings on after the last setpoint.
long double residual_amplitude(const std::vector<Signal>& setpoints, Signal start, const Mode& mode) {
  const long double w = 2 * 3.14159265358979323846264338327950288L * mode.frequency_hz;
  const long double zeta = mode.damping_ratio;
  const long double root = std::sqrt(1 - zeta * zeta);
  const Complex pole = std::exp(Complex(-zeta * w, w * root) * static_cast<long double>(0.001L));
  Complex swing = 0;
  Signal last = start;
  for (const Signal setpoint : setpoints) {
    swing = swing * pole + static_cast<long double>(setpoint - last) / 4294967296.0L;
    last = setpoint;
  }
  return std::abs(swing) / root;
}

// Rounding: the profile and each stage err by at most half an LSB a sample, independent from tick to tick, so their
// increments by one; summed along |pole|^n for ever. A bound, not an estimate.
long double rounding_floor(const Mode& mode, uint32_t stages, uint32_t ticks) {
  const long double w = 2 * 3.14159265358979323846264338327950288L * mode.frequency_hz;
  const long double decay = std::exp(-mode.damping_ratio * w * 0.001L);
  const long double sum = decay < 1 ? std::min((1 - std::pow(decay, ticks)) / (1 - decay), 1.0L * ticks) : ticks;
  const long double turn = std::abs(1.0L - std::exp(Complex(-mode.damping_ratio * w, w) * 0.001L));
  // summation by parts: errors e_n, not their differences, times |1 - pole|
  return (stages + 1.0L) * 0.5L / 4294967296.0L * (turn * sum + 1) /
         std::sqrt(1 - mode.damping_ratio * mode.damping_ratio);
}

struct Arm {
  Axis<8192> axis = {};
  Arm() { TEST_ASSERT_OK(axis.configure(AxisConfig{kTick, {1e9, 1e12, 1e12, 1e15}, 40e6, 2e9})); }

  // False where there is no such shaper for the mode, or none that the tick can hold.
  bool shape(ShaperKind kind, const Mode& mode) {
    ShaperDesign design{};
    const Status status = add_shaper(kind, mode, kTick, design);
    if (!status.ok()) return false;
    TEST_ASSERT_OK(axis.set_shaper(design));
    axis.tick();
    return true;
  }

  std::vector<Signal> run(int32_t target, const AxisLimits& limits) {
    axis.reset(0);
    TEST_ASSERT_OK(axis.command(Move{target, ProfileKind::kSCurve, limits, 0.0, false}, nullptr));
    std::vector<Signal> setpoints;
    do {
      setpoints.push_back(axis.tick());
    } while (axis.state().phase != AxisPhase::kAtRest);
    return setpoints;
  }
};

}  // namespace

TEST_F(Arm, shaped_moves_leave_a_millionth_of_the_plain_vibration_over_all_modes) {
  const uint64_t seed = 2017;
  TEST_INFO("seed", seed);
  Random random(seed);
  int counted = 0;
  double worst = 0.0;
  for (int i = 0; i < 600; ++i) {
    TEST_INFO("case", i);
    const Mode mode{0.5 * std::pow(600.0, random.unit()), i % 4 == 0 ? 0.0 : random.between(0.0, 0.3)};
    const int32_t target = static_cast<int32_t>(std::pow(10.0, random.between(4.0, 8.0)));
    const double velocity = target * random.between(1.0, 10.0);
    const double acceleration = velocity * random.between(5.0, 200.0);
    const AxisLimits limits{velocity, acceleration, acceleration, acceleration * random.between(20.0, 2000.0)};
    TEST_ASSERT_TRUE(shape(ShaperKind::kNone, mode));
    const std::vector<Signal> plain = run(target, limits);
    // Those with a zero on the mode by design.
    constexpr ShaperKind kKinds[] = {ShaperKind::kZv,  ShaperKind::kZvd,  ShaperKind::kZvdd,
                                     ShaperKind::kMzv, ShaperKind::kEi2,  ShaperKind::kCv2,
                                     ShaperKind::kCv4, ShaperKind::kUmZv, ShaperKind::kZvddd};
    if (!shape(kKinds[i % 9], mode)) continue;
    const uint32_t stages = axis.shaper().stage_count;
    const std::vector<Signal> shaped = run(target, limits);
    // compared at the time each stands
    const long double before = residual_amplitude(plain, 0, mode);
    const long double after = residual_amplitude(shaped, 0, mode);
    const long double floor = rounding_floor(mode, stages, static_cast<uint32_t>(shaped.size()));
    if (before < 1e6L * floor) continue;
    ++counted;
    worst = std::max(worst, static_cast<double>((after - floor) / before));
    TEST_ASSERT_AT_MOST_DOUBLE(static_cast<double>(1e-6L * before + floor), static_cast<double>(after));
  }
  MESSAGE("moves with a plain amplitude of a million floors: ", counted, ", worst shaped / plain: ", worst);
  TEST_ASSERT_AT_LEAST_INT64(200, counted);
}

TEST_F(Arm, halts_and_changes_of_target_in_flight_are_as_still_as_moves) {
  const uint64_t seed = 2018;
  TEST_INFO("seed", seed);
  Random random(seed);
  int counted = 0;
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    TEST_INFO("case", i);
    const Mode mode{random.between(2.0, 100.0), random.between(0.0, 0.2)};
    const AxisLimits limits{1.2e6, random.between(5e6, 30e6), random.between(5e6, 30e6), random.between(2e8, 1e10)};
    const uint32_t at = static_cast<uint32_t>(random.integer(20, 1000));
    const bool halt = i % 2 == 0;
    const auto target = static_cast<int32_t>(random.integer(-1000000, 2000000));
    long double amplitude[2] = {};
    long double floor = 0.0L;
    for (int shaped = 0; shaped < 2; ++shaped) {
      TEST_ASSERT_TRUE(shape(shaped == 0 ? ShaperKind::kNone : ShaperKind::kZvd, mode));
      axis.reset(0);
      TEST_ASSERT_OK(axis.command(Move{1700000, ProfileKind::kSCurve, limits, 0.0, false}, nullptr));
      std::vector<Signal> setpoints;
      do {
        if (setpoints.size() == at) {
          TEST_ASSERT_OK(halt ? axis.halt(limits, nullptr)
                              : axis.command(Move{target, ProfileKind::kSCurve, limits, 0.0, false}, nullptr));
        }
        setpoints.push_back(axis.tick());
      } while (setpoints.size() < at + 10 || axis.state().phase != AxisPhase::kAtRest);
      amplitude[shaped] = residual_amplitude(setpoints, 0, mode);
      floor = rounding_floor(mode, axis.shaper().stage_count, static_cast<uint32_t>(setpoints.size()));
    }
    if (amplitude[0] < 1e6L * floor) continue;
    ++counted;
    worst = std::max(worst, static_cast<double>((amplitude[1] - floor) / amplitude[0]));
    TEST_ASSERT_AT_MOST_DOUBLE(static_cast<double>(1e-6L * amplitude[0] + floor), static_cast<double>(amplitude[1]));
  }
  MESSAGE("halts and retargets with a plain amplitude of a million floors: ", counted, ", worst: ", worst);
  TEST_ASSERT_AT_LEAST_INT64(100, counted);
}

TEST_F(Arm, moves_begun_after_a_blended_retune_is_active_are_still) {
  const AxisLimits limits{1.2e6, 20e6, 20e6, 600e6};
  const Mode modes[] = {{37.0, 0.0}, {30.0, 0.0}};
  const ShaperKind kinds[] = {ShaperKind::kZv, ShaperKind::kEi2};
  TEST_ASSERT_TRUE(shape(ShaperKind::kNone, modes[0]));
  const std::vector<Signal> plain = run(1700000, limits);
  TEST_ASSERT_TRUE(shape(kinds[0], modes[0]));
  for (int to = 1; to <= 6; ++to) {
    TEST_INFO("change", to);
    ShaperDesign next{};
    TEST_ASSERT_OK(add_shaper(kinds[to % 2], modes[to % 2], kTick, next));
    axis.reset(0);
    const AxisLimits slower{1.0e6, 10e6, 10e6, 300e6};
    TEST_ASSERT_OK(axis.command(Move{1700000, ProfileKind::kSCurve, slower, 0.0, false}, nullptr));
    for (int tick = 0; tick < 300 + 50 * to; ++tick) axis.tick();
    TEST_ASSERT_OK(axis.set_shaper(next, Retune::kBlended));
    while (axis.state().phase != AxisPhase::kAtRest) {
      axis.tick();
      axis.service();
    }
    axis.tick();
    TEST_ASSERT_FALSE(axis.pending());
    const std::vector<Signal> shaped = run(1700000, limits);
    const Mode mode = modes[to % 2];
    const long double before = residual_amplitude(plain, 0, mode);
    const long double floor = rounding_floor(mode, 1, static_cast<uint32_t>(shaped.size()));
    TEST_ASSERT_AT_MOST_DOUBLE(static_cast<double>(1e-6L * before + floor),
                               static_cast<double>(residual_amplitude(shaped, 0, mode)));
  }
}

TEST_F(Arm, a_shaper_for_the_wrong_mode_leaves_the_arm_swinging) {
  // The measurement can fail: 20 % off the frequency, ZV leaves a good part.
  const AxisLimits limits{1.2e6, 20e6, 20e6, 600e6};
  TEST_ASSERT_TRUE(shape(ShaperKind::kNone, Mode{11.0, 0.0}));
  const long double before = residual_amplitude(run(1700000, limits), 0, Mode{11.0, 0.0});
  TEST_ASSERT_TRUE(shape(ShaperKind::kZv, Mode{13.2, 0.0}));
  const long double after = residual_amplitude(run(1700000, limits), 0, Mode{11.0, 0.0});
  TEST_ASSERT_AT_LEAST_DOUBLE(0.1, static_cast<double>(after / before));
  TEST_ASSERT_AT_MOST_DOUBLE(0.5, static_cast<double>(after / before));
}
