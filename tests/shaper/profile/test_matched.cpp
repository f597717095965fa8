// SPDX-License-Identifier: Apache-2.0
// Moves fitted to a mode: still on an arm that this test integrates by its own method, and within their limits.
#include "shaper/profile/matched.hpp"
#include "shaper/profile/track.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

#ifndef STILLPOINT_CHIP_TESTS
#include <algorithm>
#include <cmath>
#include <complex>
#include <initializer_list>
#include <vector>
#endif

using namespace stillpoint;
using stillpoint::testing::Random;
using stillpoint::testing::StreamCheck;

namespace {

constexpr double kTick = 1e-3;
constexpr AxisLimits kReference{1.2e6, 20e6, 20e6, 600e6};

ProfileDetail mode(double frequency_hz, double damping_ratio) {
  return ProfileDetail{nullptr, frequency_hz, damping_ratio, plan_matched};
}

Plan planned(double distance, const AxisLimits& limits, const ProfileDetail& detail) {
  Plan plan{};
  TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, ProfileKind::kMatched, kTick, plan, detail));
  return plan;
}

void check_move(const Plan& plan, const AxisLimits& limits, int32_t start_counts, int32_t target_counts) {
  const Signal target = signal_from_counts(target_counts);
  static Track track;
  Track::make(plan, signal_from_counts(start_counts), target, track);
  Sampler sampler;
  sampler.begin(track);
  AxisLimits looser = limits;
  looser.jerk = limits.larger_jerk();
  StreamCheck check(signal_from_counts(start_counts), target_counts >= start_counts, looser, kTick);
  for (uint32_t tick = 1; tick <= plan.duration_ticks + 3; ++tick) {
    const Signal signal = sampler.tick();
    check.next(signal);
    if (tick >= plan.duration_ticks) TEST_ASSERT_EQUAL_INT64(target, signal);
  }
  TEST_INFO("form", static_cast<int>(plan.matched.form));
  TEST_INFO("velocity excess LSB", check.velocity_excess);
  TEST_INFO("acceleration excess LSB", check.acceleration_excess);
  TEST_INFO("jerk excess LSB", check.jerk_excess);
  TEST_ASSERT_TRUE(check.within(0));
  // Between a base and its repetition it may stand: as well as the plan's doubles, four roundings of the velocity, can.
  const double fastest = peaks_of(plan, kTick).velocity * kTick * 4294967296.0;
  TEST_ASSERT_AT_MOST_DOUBLE(1.0 + 0x1p-50 * fastest, check.backwards);
}

}  // namespace

TEST(a_long_move_matches_its_ramps_with_a_period) {
  // Undamped, 12.5 Hz: constant acceleration of 80 ms instead of 60, to be reached in V / (80 ms J) = 25 ms.
  const Plan plan = planned(1.7e6, kReference, mode(12.5, 0.0));
  TEST_ASSERT_EQUAL_ENUM(MatchedForm::kRamps, plan.matched.form);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-9, 1700.0 / 1.2 + 105.0, plan.optimum_ticks);
  check_move(plan, kReference, 0, 1700000);
}

TEST(every_form_arrives_within_its_limits_stretched_too) {
  const double distances[] = {1.7e6, 4e4, 12.0};
  for (unsigned i = 0; i < 3; ++i) {
    const double distance = distances[i];
    Plan plan = planned(-distance, kReference, mode(11.0, 0.05));
    check_move(plan, kReference, 5, 5 - static_cast<int32_t>(distance));
    TEST_ASSERT_OK(stretch(plan, plan.duration_ticks + 37));
    check_move(plan, kReference, 5, 5 - static_cast<int32_t>(distance));
  }
}

TEST(matched_moves_are_the_same_bits_everywhere) {
  // GIVEN a move of every form WHEN the setpoints are hashed (FNV-1a) THEN every machine prints this number
  static Track track;
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  const int32_t targets[] = {1700000, -40000, 12};
  for (unsigned i = 0; i < 3; ++i) {
    const Plan plan = planned(targets[i], kReference, mode(11.0, 0.05));
    Track::make(plan, 0, signal_from_counts(targets[i]), track);
    Sampler sampler;
    sampler.begin(track);
    while (!sampler.at_rest()) {
      uint64_t bits = static_cast<uint64_t>(sampler.tick());
      for (int byte = 0; byte < 8; ++byte, bits >>= 8) hash = (hash ^ (bits & 0xFF)) * UINT64_C(0x100000001b3);
    }
  }
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(16983157703168126645), hash);
}

TEST(modes_that_are_none_are_refused_by_name_and_the_plan_before_stays) {
  Plan plan = planned(1000.0, kReference, mode(11.0, 0.1));
  const uint32_t before = plan.duration_ticks;
  const auto with = [&](double frequency_hz, double damping_ratio) {
    return plan_rest_to_rest(1.0, kReference, ProfileKind::kMatched, kTick, plan, mode(frequency_hz, damping_ratio));
  };
  TEST_ASSERT_REFUSED(kNotPositive, kFrequency, with(0.0, 0.1));
  TEST_ASSERT_REFUSED(kNotFinite, kFrequency, with(__builtin_nan(""), 0.1));
  TEST_ASSERT_REFUSED(kAboveMaximum, kFrequency, with(501.0, 0.1));
  TEST_ASSERT_REFUSED(kNotFinite, kDampingRatio, with(11.0, __builtin_inf()));
  TEST_ASSERT_REFUSED(kBelowMinimum, kDampingRatio, with(11.0, -0.1));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDampingRatio, with(11.0, 1.0));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDuration, with(1e-9, 0.1));
  TEST_ASSERT_EQUAL_UINT32(before, plan.duration_ticks);
  TEST_ASSERT_TRUE(plan.distance == 1000.0);
}

#ifndef STILLPOINT_CHIP_TESTS

namespace {

using Complex = std::complex<long double>;

Plan planned_plainly(double distance, const AxisLimits& limits) {
  Plan plan{};
  TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, ProfileKind::kSCurve, kTick, plan));
  return plan;
}

constexpr long double kPi = 3.14159265358979323846264338327950288L;

Complex pole_of(const ProfileDetail& detail) {
  const long double w = 2 * kPi * detail.frequency_hz;
  const long double zeta = detail.damping_ratio;
  return Complex(-zeta * w, w * std::sqrt(1 - zeta * zeta));
}

// What swings on after the last setpoint, counts: each tick's increment of the setpoint, held, adds a phasor that turns
// by the sampled pole.
long double residual_of(const Plan& plan, int32_t target, const ProfileDetail& detail) {
  static Track track;
  Track::make(plan, 0, signal_from_counts(target), track);
  Sampler sampler;
  sampler.begin(track);
  const Complex turn = std::exp(pole_of(detail) * 1e-3L);
  Complex swing = 0;
  Signal last = 0;
  for (uint32_t tick = 1; tick <= plan.duration_ticks; ++tick) {
    const Signal now = sampler.tick();
    swing = swing * turn + static_cast<long double>(now - last) / 4294967296.0L;
    last = now;
  }
  return std::abs(swing);
}

// The same of the continuous move, by the integral of the velocity with the mode's impulse response: segment by segment
// in closed form by parts, exact. Relative to the distance.
long double continuous_residual_of(const Plan& plan, const ProfileDetail& detail) {
  const Complex p = pole_of(detail) * 1e-3L;
  Complex swing = 0;
  long double v = 0;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& s = plan.segments[i];
    const long double t = s.duration_ticks;
    const long double a = s.acceleration;
    const long double j = s.jerk;
    const auto primitive = [&](long double velocity, long double acceleration) {
      return velocity / p + acceleration / (p * p) + j / (p * p * p);
    };
    const long double v_end = v + t * (a + t * j / 2);
    // int_0^t v(x) e^{p (t - x)} dx = e^{pt} F(0) - F(t), F = v/p + v'/p^2 + v''/p^3
    swing = swing * std::exp(p * t) + std::exp(p * t) * primitive(v, a) - primitive(v_end, a + j * t);
    v = v_end;
  }
  return std::abs(swing) / std::abs(static_cast<long double>(plan.distance));
}

AxisLimits random_limits(Random& random, double distance) {
  const double velocity = distance * std::pow(10.0, random.between(0.0, 2.0));
  const double acceleration = velocity * std::pow(10.0, random.between(0.0, 2.5));
  const double jerk = acceleration * std::pow(10.0, random.between(0.5, 3.0));
  const bool even = random.next() % 2 == 0;
  return AxisLimits{velocity, acceleration, even ? acceleration : acceleration * random.between(0.3, 3.0), jerk,
                    even ? 0.0 : jerk * random.between(0.3, 3.0)};
}

ProfileDetail random_mode(Random& random) {
  const double frequency_hz = std::pow(10.0, random.between(-0.3, 2.0));
  return mode(frequency_hz, random.next() % 4 == 0 ? 0.0 : random.between(0.0, 0.3));
}

// The shortest matched ramps over a fine grid of peak velocities, by their own sums: x is found by bisection on the
// peaks of the convolution, evaluated on a grid.
struct SlowOracle {
  double half;
  double decay;

  double peak_share(double x) const {  // largest part of the pattern's area that a window of x sees, per x
    const auto area = [&](double t) {
      const double first = std::min(std::max(t, 0.0), half);
      const double second = std::min(std::max(t - half, 0.0), half);
      return (first + decay * second) / (half * (1 + decay));
    };
    double best = 0.0;
    for (int i = 0; i <= 400; ++i) {
      const double end = (2 * half + x) * i / 400;
      best = std::max(best, area(end) - area(end - x));
    }
    return std::max(best, area(x)) / x;
  }
  double other_box(double velocity, double acceleration, double jerk) const {
    double low = std::max(velocity / (half * (1 + decay) * jerk), 1.0 / 1024);
    if (velocity * peak_share(low) <= acceleration) return low;
    double high = low;
    while (velocity * peak_share(high) > acceleration) high *= 2;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (velocity * peak_share(middle) > acceleration ? low : high) = middle;
    }
    return high;
  }
};

}  // namespace

TEST_HOST(random_matched_moves_are_still_and_keep_their_limits) {
  const uint64_t seed = 401;
  TEST_INFO("seed", seed);
  Random random(seed);
  int done = 0;
  int forms[4] = {};
  int shorter = 0;
  long double worst_continuous = 0;
  for (int i = 0; done < 20000; ++i) {
    TEST_INFO("case", i);
    const double distance = std::floor(std::pow(10.0, random.between(2.0, 8.0)));
    const AxisLimits limits = random_limits(random, distance);
    const ProfileDetail detail = random_mode(random);
    TEST_INFO("frequency", detail.frequency_hz);
    TEST_INFO("damping", detail.damping_ratio);
    const bool forward = random.next() % 2 == 0;
    Plan plan = planned(forward ? distance : -distance, limits, detail);
    if (plan.duration_ticks > 1500) continue;
    ++done;
    ++forms[static_cast<int>(plan.matched.form)];
    TEST_INFO("form", static_cast<int>(plan.matched.form));
    TEST_ASSERT_TRUE(plan.duration_ticks == std::ceil(plan.optimum_ticks * (1 - 1e-9)));
    // Between the plain optimum and the same behind a shaper.
    if (limits.deceleration_jerk == 0.0) {
      const double root = std::sqrt(1 - detail.damping_ratio * detail.damping_ratio);
      const double shaped = planned_plainly(distance, limits).optimum_ticks + 500.0 / detail.frequency_hz / root;
      TEST_ASSERT_AT_MOST_DOUBLE(shaped * (1 + 1e-9) + 0.01, plan.optimum_ticks);
      if (plan.optimum_ticks < shaped - 0.5) ++shorter;
    }
    if (i % 2 == 0) {
      const double longer = plan.duration_ticks * random.between(1.0, 2.5);
      TEST_ASSERT_OK(stretch(plan, static_cast<uint32_t>(longer) + 1));
    }
    worst_continuous = std::max(worst_continuous, continuous_residual_of(plan, detail));
    TEST_ASSERT_AT_MOST_DOUBLE(1e-10, static_cast<double>(continuous_residual_of(plan, detail)));
    check_move(plan, limits, 0, static_cast<int32_t>(forward ? distance : -distance));
  }
  MESSAGE("matched ramps: ", forms[1], ", velocity: ", forms[2], ", shifted: ", forms[3],
          ", shorter than shaped by half a tick: ", shorter,
          ", worst continuous residual of the distance: ", static_cast<double>(worst_continuous));
  for (int form = 1; form < 4; ++form) TEST_ASSERT_AT_LEAST_INT64(300, forms[form]);
}

TEST_HOST(no_peak_velocity_of_a_fine_grid_makes_matched_ramps_shorter) {
  const uint64_t seed = 402;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 300; ++i) {
    TEST_INFO("case", i);
    const double distance = 1e6;
    const AxisLimits l = random_limits(random, distance);
    const ProfileDetail detail = random_mode(random);
    const Plan plan = planned(distance, l, detail);
    const double root = std::sqrt(1 - detail.damping_ratio * detail.damping_ratio);
    const SlowOracle oracle{500.0 / detail.frequency_hz / root,
                            std::exp(-3.14159265358979324 * detail.damping_ratio / root)};
    double best = 1e300;
    for (int k = 1; k <= 200; ++k) {
      const double v = l.velocity * kTick * k / 200;
      const double up = oracle.other_box(v, l.acceleration * 1e-6, l.jerk * 1e-9);
      const double down = oracle.other_box(v, l.deceleration * 1e-6, l.braking_jerk() * 1e-9);
      const double begins = distance / v + (up - down) / 2;
      if (begins < 2 * oracle.half + up) continue;
      best = std::min(best, begins + 2 * oracle.half + down);
    }
    TEST_ASSERT_AT_MOST_DOUBLE(best * (1 + 1e-4), plan.optimum_ticks);  // the oracle's windows lie on a grid
  }
}

TEST_HOST(what_the_ticks_leave_of_a_matched_move_is_small) {
  const auto compare = [](double frequency_hz, double damping_ratio, double distance) {
    const ProfileDetail detail = mode(frequency_hz, damping_ratio);
    const auto target = static_cast<int32_t>(distance);
    const Plan matched = planned(distance, kReference, detail);
    // The plain move's own residual depends on its length; that of the same move a little longer may be anything. So
    // the largest over a period of lengths.
    long double plain = 0;
    Plan longer = planned_plainly(distance, kReference);
    const auto period = static_cast<uint32_t>(1000.0 / frequency_hz);
    const uint32_t least = longer.duration_ticks;
    for (uint32_t k = 0; k <= period; k += 1 + period / 40) {
      TEST_ASSERT_OK(stretch(longer, least + k));
      plain = std::max(plain, residual_of(longer, target, detail));
    }
    return static_cast<double>(residual_of(matched, target, detail) / plain);
  };
  const double frequencies[] = {1.0, 11.0, 40.0, 100.0};
  const double bounds[] = {1e-8, 1e-6, 1e-4, 5e-3};
  for (int i = 0; i < 4; ++i) {
    double worst = 0.0;
    for (const double damping : {0.0, 0.02, 0.11, 0.3}) {
      for (const double distance : {1.7e6, 3.3e5, 4e4})
        worst = std::max(worst, compare(frequencies[i], damping, distance));
    }
    MESSAGE(frequencies[i], " Hz: worst residual over the plain S-curve's ", worst);
    TEST_ASSERT_AT_MOST_DOUBLE(bounds[i], worst);
  }
}

TEST_HOST(a_matched_move_for_the_wrong_mode_leaves_the_arm_swinging) {
  // The measurement can fail: 20 % off the frequency leaves a good part.
  const Plan plan = planned(1.7e6, kReference, mode(13.2, 0.02));
  const long double wrong = residual_of(plan, 1700000, mode(11.0, 0.02));
  const long double right = residual_of(plan, 1700000, mode(13.2, 0.02));
  TEST_ASSERT_AT_LEAST_DOUBLE(1e4, static_cast<double>(wrong / right));
}

#endif
