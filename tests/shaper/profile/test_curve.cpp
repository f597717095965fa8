// SPDX-License-Identifier: Apache-2.0
// Moves of sine ramps, polynomials and tables, from the plan to the emitted stream.
#include "shaper/profile/curve_plan.hpp"
#include "shaper/profile/track.hpp"
#include "tests/support/stream_check.hpp"
#include "tests/support/test.hpp"

#ifndef STILLPOINT_CHIP_TESTS
#include <algorithm>
#include <cmath>
#include <initializer_list>
#endif

using namespace stillpoint;
using stillpoint::testing::Random;
using stillpoint::testing::StreamCheck;

namespace {

constexpr double kTick = 1e-3;
constexpr ProfileKind kCurves[] = {ProfileKind::kSin2, ProfileKind::kPoly5, ProfileKind::kPoly7};

// 3 t^2 - 2 t^3, and one that overshoots by 1.1 % and comes back, unlike in both directions.
constexpr int64_t kCubicNodes[] = {0, 0, kTableOne, 0};
constexpr ProfileTable kCubic = {1, 1, kCubicNodes, {1.5, 6.0, 6.0, 12.0}};
constexpr int64_t kUnevenNodes[] = {0, 0, 0, kTableOne * 3 / 4, kTableOne / 4, -kTableOne / 16, kTableOne, 0, 0};
ProfileTable uneven() {
  ProfileTable table = {2, 2, kUnevenNodes, {}};
  table.peaks = peaks_of_nodes(table);
  return table;
}

struct Run {
  Track track;
  Sampler sampler;
  void begin(const Plan& plan, Signal start, Signal target) {
    Track::make(plan, start, target, track);
    sampler.begin(track);
  }
};

Plan planned(double distance, const AxisLimits& limits, ProfileKind kind, const ProfileTable* table = nullptr) {
  Plan plan{};
  TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, kind, kTick, plan, ProfileDetail{table}));
  return plan;
}

void check_move(const Plan& plan, const AxisLimits& limits, int32_t start_counts, int32_t target_counts,
                bool jerk_limited = true, bool monotone = true) {
  const Signal start = signal_from_counts(start_counts);
  const Signal target = signal_from_counts(target_counts);
  Run run;
  run.begin(plan, start, target);
  AxisLimits looser = limits;
  looser.jerk = limits.larger_jerk();
  StreamCheck check(start, target >= start, looser, kTick);
  for (uint32_t tick = 1; tick <= plan.duration_ticks + 3; ++tick) {
    const Signal signal = run.sampler.tick();
    check.next(signal);
    if (tick >= plan.duration_ticks) TEST_ASSERT_EQUAL_INT64(target, signal);
  }
  TEST_ASSERT_TRUE(run.sampler.at_rest());
  TEST_INFO("velocity excess LSB", check.velocity_excess);
  TEST_INFO("acceleration excess LSB", check.acceleration_excess);
  TEST_INFO("jerk excess LSB", check.jerk_excess);
  TEST_ASSERT_TRUE(check.within(0, jerk_limited));
  if (monotone) TEST_ASSERT_AT_MOST_DOUBLE(1.0, check.backwards);
}

}  // namespace

TEST(each_kind_takes_the_time_of_its_closed_form) {
  // D 1.7, V 1.2, A 20, J 600: sine ramps of pi V / 2A = 94 ms against pi sqrt(V / 2J) = 99 ms.
  const AxisLimits limits{1.2, 20.0, 20.0, 600.0};
  const double pi = 3.14159265358979323846;
  TEST_ASSERT_DOUBLE_RELATIVE(1e-10, (1.7 / 1.2 + pi * 0.031622776601683794) * 1e3,
                              planned(1.7, limits, ProfileKind::kSin2).optimum_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-13, 1.875 * 1.7 / 1.2 * 1e3, planned(1.7, limits, ProfileKind::kPoly5).optimum_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-13, 2.1875 * 1.7 / 1.2 * 1e3, planned(1.7, limits, ProfileKind::kPoly7).optimum_ticks);
  // 1 mm: by jerk. cbrt(60 D / J), cbrt(52.5 D / J); two sine ramps of which each takes (pi^2 D / 2J)^(1/3).
  TEST_ASSERT_DOUBLE_RELATIVE(1e-10, 2e3 * 0.020185499456904267,
                              planned(0.001, limits, ProfileKind::kSin2).optimum_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-13, 46.415888336127786, planned(0.001, limits, ProfileKind::kPoly5).optimum_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-13, 44.39520008713004, planned(0.001, limits, ProfileKind::kPoly7).optimum_ticks);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-13, 1.5 * 1.7 / 1.2 * 1e3,
                              planned(1.7, limits, ProfileKind::kTable, &kCubic).optimum_ticks);
}

TEST(a_polynomial_move_is_its_polynomial) {
  const AxisLimits limits{1.2e6, 20e6, 20e6, 600e6};
  const Plan plan = planned(-262144.0, limits, ProfileKind::kPoly5);
  Run run;
  run.begin(plan, 0, signal_from_counts(-262144));
  for (uint32_t tick = 1; tick <= plan.duration_ticks; ++tick) {
    const double x = static_cast<double>(tick) / plan.duration_ticks;
    const double expected = -262144.0 * x * x * x * (10.0 + x * (6.0 * x - 15.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, expected, static_cast<double>(run.sampler.tick()) / 4294967296.0);
  }
}

TEST(a_curve_of_one_count_arrives_within_its_limits) {
  const AxisLimits limits{1200.0, 20e3, 30e3, 600e3};
  for (unsigned i = 0; i < 3; ++i) {
    check_move(planned(1.0, limits, kCurves[i]), limits, 7, 8);
    check_move(planned(-1.0, limits, kCurves[i]), limits, -7, -8);
  }
}

TEST(the_longest_curve_arrives_within_its_limits) {
  const AxisLimits limits{3e9, 4e10, 2e10, 2e12};
  for (unsigned i = 0; i < 3; ++i) {
    TEST_INFO("curve", i);
    check_move(planned(2147483647.0, limits, kCurves[i]), limits, INT32_MIN, -1);
    check_move(planned(-2147483647.0, limits, kCurves[i]), limits, INT32_MAX, 0);
  }
}

TEST(limits_out_of_all_proportion_give_one_tick_and_a_step) {
  const AxisLimits limits{1e300, 1e300, 1e300, 1e300};
  for (unsigned i = 0; i < 3; ++i) {
    const Plan plan = planned(100.0, limits, kCurves[i]);
    TEST_ASSERT_EQUAL_UINT32(1, plan.duration_ticks);
    check_move(plan, limits, 0, 100);
  }
}

TEST(a_ramp_shorter_than_a_tick_beside_a_long_one_keeps_its_limits) {
  const AxisLimits up_at_once{1.2e6, 1e13, 20e6, 1e18, 600e6};
  check_move(planned(-1700000.0, up_at_once, ProfileKind::kSin2), up_at_once, 0, -1700000);
  check_move(planned(1700.0, up_at_once, ProfileKind::kSin2), up_at_once, 0, 1700);
  const AxisLimits down_at_once{1.2e6, 20e6, 1e13, 600e6, 1e18};
  check_move(planned(1700000.0, down_at_once, ProfileKind::kSin2), down_at_once, 0, 1700000);
  check_move(planned(-1700.0, down_at_once, ProfileKind::kSin2), down_at_once, 0, -1700);
}

TEST(a_stretched_curve_takes_exactly_the_ticks_asked_for_at_lower_peaks) {
  const AxisLimits limits{1.2e6, 20e6, 30e6, 600e6};
  for (unsigned i = 0; i < 3; ++i) {
    Plan plan = planned(170000.0, limits, kCurves[i]);
    const Peaks before = peaks_of(plan, kTick);
    TEST_ASSERT_AT_MOST_DOUBLE(1.2e6 * (1 + 1e-12), before.velocity);
    TEST_ASSERT_AT_MOST_DOUBLE(600e6 * (1 + 1e-12), before.jerk);
    const uint32_t ticks = plan.duration_ticks * 2;
    TEST_ASSERT_OK(stretch(plan, ticks));
    const Peaks after = peaks_of(plan, kTick);
    TEST_ASSERT_EQUAL_UINT32(ticks, plan.duration_ticks);
    TEST_ASSERT_DOUBLE_RELATIVE(1e-12, before.velocity / 2, after.velocity);
    TEST_ASSERT_DOUBLE_RELATIVE(1e-12, before.acceleration / 4, after.acceleration);
    TEST_ASSERT_DOUBLE_RELATIVE(1e-12, before.jerk / 8, after.jerk);
    check_move(plan, AxisLimits{0.6e6, 5e6, 7.5e6, 75e6}, 5, 170005);
  }
}

TEST(a_sampler_that_begins_within_a_curve_goes_on_as_one_that_came_there) {
  const ProfileTable table = uneven();
  const ProfileKind kinds[] = {ProfileKind::kSin2, ProfileKind::kPoly7, ProfileKind::kTable};
  for (unsigned i = 0; i < 3; ++i) {
    const Plan plan = planned(-12345.0, {1.2e5, 20e6, 30e6, 600e6, 900e6}, kinds[i], &table);
    Run run;
    run.begin(plan, signal_from_counts(7), signal_from_counts(7 - 12345));
    for (uint32_t tick = 0; tick <= plan.duration_ticks + 1; ++tick) {
      Sampler other;
      other.begin_at(run.track, tick);
      TEST_ASSERT_EQUAL_INT64(run.sampler.position(), other.position());
      Sampler on = run.sampler;
      for (int k = 0; k < 25; ++k) TEST_ASSERT_EQUAL_INT64(on.tick(), other.tick());
      TEST_ASSERT_TRUE(on.at_rest() == other.at_rest());
      run.sampler.tick();
    }
  }
}

TEST(the_motion_on_a_curve_is_that_of_its_neighbouring_samples) {
  const ProfileTable table = uneven();
  const ProfileKind kinds[] = {ProfileKind::kSin2, ProfileKind::kPoly5, ProfileKind::kTable};
  for (unsigned i = 0; i < 3; ++i) {
    const AxisLimits limits{1.2e6, 20e6, 30e6, 600e6};
    const Plan plan = planned(-1234567.0, limits, kinds[i], &table);
    Run run;
    run.begin(plan, 0, signal_from_counts(-1234567));
    double before = 0.0;
    double here = 0.0;
    for (uint32_t tick = 1; tick < plan.duration_ticks; ++tick) {
      TEST_INFO("tick", tick);
      const double after = static_cast<double>(run.sampler.tick()) / 4294967296.0;
      if (tick > 1) {
        uint32_t unused = 0;
        const StartMotion motion = motion_of(run.track.differences_at(tick - 1, unused), kTick);
        // what a third derivative within its limit leaves
        TEST_ASSERT_DOUBLE_WITHIN(600e6 * kTick * kTick / 4.0, (after - before) / (2.0 * kTick), motion.velocity);
        TEST_ASSERT_DOUBLE_WITHIN(600e6 * kTick, (after - 2.0 * here + before) / (kTick * kTick), motion.acceleration);
      }
      before = here;
      here = after;
    }
  }
}

TEST(curves_are_the_same_bits_everywhere) {
  // GIVEN moves of every kind WHEN the setpoints are hashed (FNV-1a) THEN every machine prints this number
  const ProfileTable table = uneven();
  const ProfileKind kinds[] = {ProfileKind::kSin2, ProfileKind::kPoly5, ProfileKind::kPoly7, ProfileKind::kTable};
  const int32_t targets[] = {170000, -1, 123457};
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  for (unsigned i = 0; i < 12; ++i) {
    const int32_t target = targets[i % 3];
    Run run;
    run.begin(planned(target, {1.2e6, 20e6, 30e6, 600e6, 900e6}, kinds[i / 3], &table), 0, signal_from_counts(target));
    while (!run.sampler.at_rest()) {
      uint64_t bits = static_cast<uint64_t>(run.sampler.tick());
      for (int byte = 0; byte < 8; ++byte, bits >>= 8) hash = (hash ^ (bits & 0xFF)) * UINT64_C(0x100000001b3);
    }
  }
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(4435051510274032439), hash);
}

TEST(tables_that_are_no_move_are_refused_by_name_and_the_plan_before_stays) {
  const AxisLimits limits{1.0, 2.0, 3.0, 4.0};
  Plan plan = planned(1.0, limits, ProfileKind::kPoly5);
  const auto with = [&](const ProfileTable* table) {
    return plan_rest_to_rest(1.0, limits, ProfileKind::kTable, kTick, plan, ProfileDetail{table});
  };
  TEST_ASSERT_REFUSED(kNotAvailable, kTable, with(nullptr));
  ProfileTable table = kCubic;
  table.order = 0;
  TEST_ASSERT_REFUSED(kBelowMinimum, kTable, with(&table));
  table.order = 4;
  TEST_ASSERT_REFUSED(kAboveMaximum, kTable, with(&table));
  table = kCubic;
  table.spans = 0;
  TEST_ASSERT_REFUSED(kBelowMinimum, kTable, with(&table));
  table.spans = kMaxTableSpans + 1;
  TEST_ASSERT_REFUSED(kAboveMaximum, kTable, with(&table));
  table = kCubic;
  table.nodes = nullptr;
  TEST_ASSERT_REFUSED(kNotAvailable, kTable, with(&table));
  const double bad[] = {0.0, -1.0, __builtin_inf(), __builtin_nan("")};
  for (unsigned i = 0; i < 4; ++i) {
    table = kCubic;
    table.peaks.jerk = bad[i];
    const Status status = with(&table);
    TEST_ASSERT_EQUAL_ENUM(i < 2 ? Error::kNotPositive : Error::kNotFinite, status.error);
    TEST_ASSERT_EQUAL_ENUM(Quantity::kTable, status.quantity);
  }
  for (unsigned i = 0; i < 4; ++i) {
    int64_t nodes[] = {0, 0, kTableOne, 0};
    nodes[i] += 1;
    table = kCubic;
    table.nodes = nodes;
    TEST_ASSERT_REFUSED(kAboveMaximum, kTable, with(&table));
  }
  int64_t huge[] = {0, 0, kTableOne, kLargestNode + 1, kTableOne, 0};
  table = ProfileTable{1, 2, huge, kCubic.peaks};
  TEST_ASSERT_REFUSED(kAboveMaximum, kTable, with(&table));
  // An acceleration at an end is a step where order 2 promises a jerk limit.
  int64_t stepping[] = {0, 0, 1, kTableOne, 0, 0};
  table = ProfileTable{2, 1, stepping, kCubic.peaks};
  TEST_ASSERT_REFUSED(kAboveMaximum, kTable, with(&table));
  TEST_ASSERT_REFUSED(kAboveMaximum, kDuration,
                      plan_rest_to_rest(1.0, {1e-9, 1, 1, 1}, ProfileKind::kSin2, kTick, plan));
  TEST_ASSERT_TRUE(plan.pieces[0].table == &kQuinticTable);
  TEST_ASSERT_EQUAL_UINT32(planned(1.0, limits, ProfileKind::kPoly5).duration_ticks, plan.duration_ticks);
}

#ifndef STILLPOINT_CHIP_TESTS

namespace {

constexpr long double kPi = 3.14159265358979323846264338327950288L;

// Another method than the planner's: bisection on the peak velocity with the sine's own peaks.
long double sine_duration(long double distance, const AxisLimits& limits) {
  const auto ramp = [](long double v, long double a, long double j) {
    return std::max(kPi * v / (2 * a), kPi * std::sqrt(v / (2 * j)));
  };
  const auto ramps = [&](long double v) {
    return ramp(v, limits.acceleration, limits.jerk) + ramp(v, limits.deceleration, limits.braking_jerk());
  };
  long double high = limits.velocity;
  if (high * ramps(high) / 2 <= distance) return distance / high + ramps(high) / 2;
  long double low = 0;
  for (int i = 0; i < 200; ++i) {
    const long double middle = (low + high) / 2;
    (middle * ramps(middle) / 2 <= distance ? low : high) = middle;
  }
  return ramps(high);
}

// Dense sampling of a table's derivatives, by finite differences of its nodes' polynomials in another form: Newton's
// divided differences with the knots repeated.
struct DenseTable {
  const ProfileTable& table;

  long double at(long double time) const {
    const uint32_t n = table.order + 1;
    const auto span = std::min(static_cast<uint32_t>(time * table.spans), table.spans - 1);
    const long double x = time * table.spans - span;
    const int64_t* node = table.nodes + span * n;
    long double d[8][8] = {};
    for (uint32_t i = 0; i < 2 * n; ++i) d[i][0] = static_cast<long double>(node[i < n ? 0 : n]) / kTableOne;
    for (uint32_t k = 1; k < 2 * n; ++k) {
      for (uint32_t i = 0; i + k < 2 * n; ++i) {
        const bool same = (i < n) == (i + k < n);
        d[i][k] =
            same ? static_cast<long double>(node[(i < n ? 0 : n) + k]) / kTableOne : d[i + 1][k - 1] - d[i][k - 1];
      }
    }
    long double sum = d[0][2 * n - 1];
    for (uint32_t k = 2 * n - 1; k-- > 0;) sum = sum * (x - (k < n ? 0 : 1)) + d[0][k];
    return sum;
  }
};

AxisLimits random_limits(Random& random, double distance) {
  const double velocity = distance * std::pow(10.0, random.between(-1.0, 3.0));
  const double acceleration = velocity * std::pow(10.0, random.between(-1.0, 3.0));
  const double jerk = acceleration * std::pow(10.0, random.between(-1, 4));
  const bool even = random.next() % 2 == 0;
  return AxisLimits{velocity, acceleration, even ? acceleration : acceleration * random.between(0.1, 10.0), jerk,
                    even ? 0.0 : jerk * random.between(0.1, 10.0)};
}

// Each third difference against the limit of the ramp that its four samples lie on.
void check_two_jerks(const Plan& plan, const AxisLimits& limits, int32_t target_counts) {
  Run run;
  run.begin(plan, 0, signal_from_counts(target_counts));
  const double lsb = 4294967296.0 * kTick * kTick * kTick;
  const double up_ends = plan.pieces[0].duration_ticks;
  const double down_begins = plan.duration_ticks - plan.pieces[plan.piece_count - 1].duration_ticks;
  double p = 0.0;
  double v = 0.0;
  double a = 0.0;
  for (uint32_t tick = 1; tick <= plan.duration_ticks + 3; ++tick) {
    const double next = std::fabs(static_cast<double>(run.sampler.tick()));
    const double change = next - p - v;
    const bool up = tick <= up_ends;
    const bool down = tick >= 3 + down_begins;
    const double limit = up ? limits.jerk : down ? limits.braking_jerk() : limits.larger_jerk();
    TEST_INFO("tick", tick);
    TEST_ASSERT_AT_MOST_DOUBLE(limit * lsb + 4.0, std::fabs(change - a));
    v = next - p;
    a = change;
    p = next;
  }
}

void check_random_moves(ProfileKind kind, uint64_t seed, const ProfileTable* table = nullptr) {
  TEST_INFO("seed", seed);
  Random random(seed);
  int done = 0;
  int whole = 0;
  for (int i = 0; done < 20000; ++i) {
    TEST_INFO("case", i);
    const double distance = std::floor(std::pow(10.0, random.between(0.0, 8.5)));
    const AxisLimits limits = random_limits(random, distance);
    const bool forward = random.next() % 2 == 0;
    const Plan plan = planned(forward ? distance : -distance, limits, kind, table);
    if (plan.duration_ticks > 1500) continue;
    ++done;
    const double least = std::ceil(plan.optimum_ticks * (1 - 1e-9));
    TEST_ASSERT_AT_LEAST_DOUBLE(least, plan.duration_ticks);
    TEST_ASSERT_AT_MOST_DOUBLE(least + 1, plan.duration_ticks);
    if (plan.duration_ticks == static_cast<uint32_t>(least)) ++whole;
    const int32_t start = static_cast<int32_t>(random.integer(-1000000000, 1000000000));
    check_move(plan, limits, start, start + static_cast<int32_t>(forward ? distance : -distance),
               limits_jerk(kind, ProfileDetail{table}), kind != ProfileKind::kTable);
  }
  MESSAGE("moves within their limits: ", done, ", of them in ceil(optimum) ticks: ", whole);
}

}  // namespace

TEST_HOST(random_sine_moves_keep_their_limits) { check_random_moves(ProfileKind::kSin2, 101); }
TEST_HOST(random_quintic_moves_keep_their_limits) { check_random_moves(ProfileKind::kPoly5, 102); }
TEST_HOST(random_septic_moves_keep_their_limits) { check_random_moves(ProfileKind::kPoly7, 103); }
TEST_HOST(random_moves_of_a_table_keep_their_limits) {
  const ProfileTable table = uneven();
  check_random_moves(ProfileKind::kTable, 104, &table);
}
TEST_HOST(random_moves_of_a_cubic_table_keep_all_limits_but_the_jerk) {
  check_random_moves(ProfileKind::kTable, 105, &kCubic);
}

TEST_HOST(sine_moves_take_the_time_that_bisection_finds_and_keep_both_jerks) {
  const uint64_t seed = 106;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 20000; ++i) {
    TEST_INFO("case", i);
    const double distance = std::floor(std::pow(10.0, random.between(0.0, 9.3)));
    const AxisLimits limits = random_limits(random, distance);
    const Plan plan = planned(-distance, limits, ProfileKind::kSin2);
    TEST_ASSERT_DOUBLE_RELATIVE(1e-11, static_cast<double>(sine_duration(distance, limits) / 1e-3L),
                                plan.optimum_ticks);
    if (plan.duration_ticks < 1000) check_two_jerks(plan, limits, -static_cast<int32_t>(distance));
  }
}

TEST_HOST(curves_are_the_same_in_any_unit) {
  const uint64_t seed = 107;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 3000; ++i) {
    TEST_INFO("case", i);
    const double distance = random.between(0.001, 2.0);
    const AxisLimits l{random.between(0.05, 3.0), random.between(0.5, 50.0), random.between(0.5, 50.0),
                       random.between(5.0, 5000.0), random.between(5.0, 5000.0)};
    for (const ProfileKind kind : kCurves) {
      const Plan metres = planned(distance, l, kind);
      for (const double s : {1e3, 1e6, 1e-6}) {
        const AxisLimits scaled{l.velocity * s, l.acceleration * s, l.deceleration * s, l.jerk * s,
                                l.deceleration_jerk * s};
        TEST_ASSERT_EQUAL_UINT32(metres.duration_ticks, planned(distance * s, scaled, kind).duration_ticks);
      }
    }
  }
}

TEST_HOST(a_million_ticks_of_a_curve_err_by_less_than_an_lsb) {
  constexpr uint32_t kTicks = 1000000;
  const int32_t target = 123456789;
  Plan plan{};
  const auto worst_of = [&](const auto& exact) {
    Run run;
    run.begin(plan, 0, signal_from_counts(target));
    long double worst = 0;
    for (uint32_t tick = 1; tick < kTicks; ++tick) {
      const auto position = static_cast<long double>(run.sampler.tick());
      worst = std::max(worst, std::fabs(position - exact(tick) * target * 4294967296.0L));
    }
    return static_cast<double>(worst);
  };
  const AxisLimits limits{1e9, 1e9, 1e9, 1e9};
  plan = planned(target, limits, ProfileKind::kPoly5);
  TEST_ASSERT_OK(stretch(plan, kTicks));
  // From the nearer end, where the oracle's own rounding is small.
  const auto mirrored = [](uint32_t tick, const auto& half) {
    return tick <= kTicks / 2 ? half(tick / 1e6L) : 1 - half((kTicks - tick) / 1e6L);
  };
  const double quintic = worst_of(
      [&](uint32_t tick) { return mirrored(tick, [](long double x) { return x * x * x * (10 + x * (6 * x - 15)); }); });
  plan = planned(target, limits, ProfileKind::kPoly7);
  TEST_ASSERT_OK(stretch(plan, kTicks));
  const double septic = worst_of([&](uint32_t tick) {
    return mirrored(tick, [](long double x) { return x * x * x * x * (35 + x * (x * (70 - 20 * x) - 84)); });
  });
  // The table read in long double, with a cruise between ramps whose ends lie between ticks.
  plan = planned(target, {2e5, 1e3, 2e3, 1e3}, ProfileKind::kSin2);
  TEST_ASSERT_OK(stretch(plan, kTicks));
  const long double up = plan.pieces[0].duration_ticks;
  const long double down = plan.pieces[2].duration_ticks;
  const long double mean = 1e6L - (up + down) / 2;
  const DenseTable ramp{kSineRampTable};
  const double sine = worst_of([&](uint32_t tick) {
    if (tick < up) return up / 2 * ramp.at(tick / up) / mean;
    if (tick <= 1e6L - down) return (tick - up / 2) / mean;
    return 1 - down / 2 * ramp.at((1e6L - tick) / down) / mean;
  });
  MESSAGE("worst error, LSB: quintic ", quintic, ", septic ", septic, ", sine ", sine);
  TEST_ASSERT_AT_MOST_DOUBLE(0.75, quintic);  // half of it is the rounding to the LSB
  TEST_ASSERT_AT_MOST_DOUBLE(0.75, septic);
  TEST_ASSERT_AT_MOST_DOUBLE(0.75, sine);
}

TEST_HOST(the_sine_ramp_is_the_sine_to_one_part_in_fifty_thousand_million) {
  const DenseTable ramp{kSineRampTable};
  long double worst = 0;
  for (int i = 0; i <= 100000; ++i) {
    const long double x = i / 100000.0L;
    worst = std::max(worst, std::fabs(ramp.at(x) - (x - std::sin(kPi * x) / kPi)));
  }
  TEST_ASSERT_AT_MOST_DOUBLE(2e-11, static_cast<double>(worst));
  TEST_ASSERT_AT_LEAST_DOUBLE(1e-12, static_cast<double>(worst));  // better would be another table
}

TEST_HOST(the_peaks_of_tables_are_those_of_dense_sampling) {
  const ProfileTable table = uneven();
  for (const ProfileTable* one : {&kQuinticTable, &kSepticTable, &kSineRampTable, &kCubic, &table}) {
    const DenseTable dense{*one};
    const TablePeaks found = peaks_of_nodes(*one);
    constexpr int kSteps = 20000;  // a multiple of all the spans
    const long double h = 1.0L / kSteps;
    TablePeaks sampled{};
    for (int i = 1; i < kSteps; ++i) {
      const auto at = [&](int k) { return dense.at((i + k) * h); };
      const auto v = static_cast<double>((at(1) - at(-1)) / (2 * h));
      const auto a = static_cast<double>((at(1) - 2 * at(0) + at(-1)) / (h * h));
      sampled.velocity = std::max(sampled.velocity, std::fabs(v));
      sampled.acceleration = std::max(sampled.acceleration, a);
      sampled.deceleration = std::max(sampled.deceleration, -a);
      if (i < 2 || i > kSteps - 2) continue;
      const auto j = static_cast<double>((at(2) - 2 * at(1) + 2 * at(-1) - at(-2)) / (2 * h * h * h));
      if (one->limits_jerk() || i % (kSteps / 2) > 2) sampled.jerk = std::max(sampled.jerk, std::fabs(j));
    }
    TEST_ASSERT_DOUBLE_RELATIVE(1e-3, sampled.velocity, found.velocity);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * found.acceleration, sampled.acceleration, found.acceleration);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * found.acceleration, sampled.deceleration, found.deceleration);
    TEST_ASSERT_DOUBLE_RELATIVE(2e-3, sampled.jerk, found.jerk);
    if (one == &table) continue;
    // and what the table says is what is found
    TEST_ASSERT_DOUBLE_RELATIVE(1e-12, found.velocity, one->peaks.velocity);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, found.acceleration, one->peaks.acceleration);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, found.deceleration, one->peaks.deceleration);
    TEST_ASSERT_DOUBLE_RELATIVE(1e-12, found.jerk, one->peaks.jerk);
  }
}

#endif
