// SPDX-License-Identifier: Apache-2.0
// The shapers in continuous time against the tables of the reference, section 2.
#include "shaper/shaping/prototype.hpp"

#include "tests/shaper/shaping/residual_oracle.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::edge_towards;
using stillpoint::testing::Extreme;
using stillpoint::testing::extreme_between;
using stillpoint::testing::Real;
using stillpoint::testing::residual_ratio;

namespace {

constexpr double kNone = -1.0;
constexpr double kTolerance = 0.05;

Prototype made(ShaperKind kind, double damping_ratio, double spacing = 0.0) {
  Prototype prototype{};
  const ShaperSpec spec{kind, Mode{1.0, damping_ratio}, kTolerance, spacing, nullptr};
  TEST_ASSERT_OK(make_prototype(spec.with_defaults(), prototype));
  return prototype;
}

double lower_edge(const Prototype& prototype, double damping_ratio) {
  const Real above_humps = kTolerance * (1 + 1e-9);
  return static_cast<double>(
      edge_towards(prototype.train, damping_ratio, above_humps, prototype.zeros[0].ratio, 0.02, 0.02));
}

double upper_edge(const Prototype& prototype, double damping_ratio) {
  const Real above_humps = kTolerance * (1 + 1e-9);
  const double highest = prototype.zeros[prototype.zero_count - 1].ratio;
  return static_cast<double>(edge_towards(prototype.train, damping_ratio, above_humps, highest, 4.0, 0.02));
}

// An impulse of a convolution of ZV shapers is an impulse of each: the length is the sum.
double length_of(const Prototype& prototype) {
  double sum = 0.0;
  for (uint32_t i = 0; i < prototype.train.part_count; ++i) {
    const Cascade::Part& part = prototype.train.parts[i];
    sum += prototype.train.impulses[part.first + part.count - 1].time;
  }
  return sum;
}

struct ConvolutionRow {
  ShaperKind kind;
  double damping_ratio;
  double offset[2];  // the outer last, as printed
  uint32_t zeros;
  double zero_hz[5];  // of a shaper for 4 Hz
  double duration;
  double lower;
  double upper;
};

constexpr ConvolutionRow kConvolutions[] = {
    {ShaperKind::kCv1, 0.0, {0.142157, kNone}, 2, {3.4314, 4.5686}, 1.02063, 0.79785, 1.20365},
    {ShaperKind::kCv2, 0.0, {0.320597, kNone}, 3, {2.7176, 4, 5.2824}, 1.61456, 0.62620, 1.39345},
    {ShaperKind::kCv3, 0.0, {0.204655, 0.469343}, 4, {2.1226, 3.1814, 4.8186, 5.8774}, 2.32623, 0.48808, 1.70731},
    {ShaperKind::kCv4, 0.0, {0.361661, 0.577120}, 5, {1.6915, 2.5534, 4, 5.4466, 6.3085}, 3.14988, 0.38865, 2.16837},
    {ShaperKind::kCv1, 0.1, {0.168304, kNone}, 2, {3.3268, 4.6732}, 1.03434, 0.76485, 1.24832},
    {ShaperKind::kCv2, 0.1, {0.368977, kNone}, 3, {2.5241, 4, 5.4759}, 1.66595, 0.57439, 1.53538},
    {ShaperKind::kCv3, 0.1, {0.278171, 0.545201}, 4, {1.8192, 2.8873, 5.1127, 6.1808}, 2.51947, 0.41327, 2.37834},
    {ShaperKind::kCv4, 0.1, {0.454481, 0.658556}, 5, {1.3658, 2.1821, 4, 5.8179, 6.6342}, 3.54392, 0.30993, 4.0},
};

struct BandRow {
  ShaperKind kind;
  double duration;
  double width;
};

constexpr BandRow kBands[] = {
    {ShaperKind::kZv, 0.5, 0.0637},      {ShaperKind::kZvd, 1.0, 0.2871},     {ShaperKind::kZvdd, 1.5, 0.4804},
    {ShaperKind::kZvddd, 2, 0.6271},     {ShaperKind::kEi, 1.0, 0.3994},      {ShaperKind::kEi2, 1.5, 0.7245},
    {ShaperKind::kEi3, 2.0, 0.9639},     {ShaperKind::kCv1, 1.02063, 0.4058}, {ShaperKind::kCv2, 1.61456, 0.7673},
    {ShaperKind::kCv3, 2.32623, 1.2192}, {ShaperKind::kCv4, 3.14988, 1.7797},
};

struct TrainRow {
  ShaperKind kind;
  double damping_ratio;
  uint32_t count;
  double amplitude[5];
  double time[5];  // over the damped period
  double zero[4];
};

constexpr TrainRow kTrains[] = {
    {ShaperKind::kEi, 0.1, 3, {0.35471, 0.45342, 0.19187}, {0, 0.50260, 0.99591}, {0.8394, 1.1690}},
    {ShaperKind::kEi2,
     0.1,
     4,
     {0.25870, 0.36010, 0.27236, 0.10883},
     {0, 0.51333, 1.00290, 1.48142},
     {0.6560, 1, 1.3833}},
    {ShaperKind::kEi3,
     0.1,
     5,
     {0.22060, 0.27756, 0.25983, 0.16688, 0.07514},
     {0, 0.53793, 1.02395, 1.49926, 1.96101},
     {0.5228, 0.8106, 1.1987, 1.5562}},
};

void check_undamped(ShaperKind kind, const double* amplitudes, uint32_t count) {
  const Prototype prototype = made(kind, 0.0);
  TEST_ASSERT_EQUAL_UINT32(count, prototype.train.impulse_count);
  for (uint32_t i = 0; i < count; ++i) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, amplitudes[i], prototype.train.impulses[i].amplitude);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0.5 * i, prototype.train.impulses[i].time);
  }
  for (uint32_t k = 0; k < prototype.zero_count; ++k) {
    const double ratio = prototype.zeros[k].ratio;
    TEST_ASSERT_AT_MOST_DOUBLE(1e-9, residual_ratio(prototype.train, ratio, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 2.0, ratio + prototype.zeros[prototype.zero_count - 1 - k].ratio);
  }
}

}  // namespace

TEST(convolutions_have_the_offsets_and_zeros_of_the_reference) {
  for (const ConvolutionRow& row : kConvolutions) {
    TEST_INFO("kind", static_cast<uint32_t>(row.kind));
    TEST_INFO("damping", row.damping_ratio);
    const Prototype prototype = made(row.kind, row.damping_ratio);
    TEST_ASSERT_EQUAL_UINT32(row.zeros, prototype.zero_count);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, row.offset[row.offset[1] == kNone ? 0 : 1], 1.0 - prototype.zeros[0].ratio);
    if (row.offset[1] != kNone) TEST_ASSERT_DOUBLE_WITHIN(2e-6, row.offset[0], 1.0 - prototype.zeros[1].ratio);
    for (uint32_t k = 0; k < row.zeros; ++k) {
      TEST_ASSERT_DOUBLE_WITHIN(1e-4, row.zero_hz[k], 4.0 * prototype.zeros[k].ratio);
      TEST_ASSERT_DOUBLE_WITHIN(1e-12, row.damping_ratio, prototype.zeros[k].damping_ratio);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, row.duration, length_of(prototype));
  }
}

TEST(convolutions_keep_the_band_of_the_reference) {
  for (const ConvolutionRow& row : kConvolutions) {
    TEST_INFO("kind", static_cast<uint32_t>(row.kind));
    TEST_INFO("damping", row.damping_ratio);
    const Prototype prototype = made(row.kind, row.damping_ratio);
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, row.lower, lower_edge(prototype, row.damping_ratio));
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, row.upper, upper_edge(prototype, row.damping_ratio));
  }
}

TEST(undamped_bands_are_as_wide_as_the_reference_says) {
  for (const BandRow& row : kBands) {
    TEST_INFO("kind", static_cast<uint32_t>(row.kind));
    const Prototype prototype = made(row.kind, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, row.duration, length_of(prototype));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, row.width, upper_edge(prototype, 0.0) - lower_edge(prototype, 0.0));
  }
}

TEST(damped_extra_insensitive_trains_are_those_of_the_reference) {
  for (const TrainRow& row : kTrains) {
    TEST_INFO("kind", static_cast<uint32_t>(row.kind));
    const Prototype prototype = made(row.kind, row.damping_ratio);
    const double root = math::sqrt(1.0 - row.damping_ratio * row.damping_ratio);
    TEST_ASSERT_EQUAL_UINT32(row.count, prototype.train.impulse_count);
    TEST_ASSERT_EQUAL_UINT32(row.count - 1, prototype.zero_count);
    for (uint32_t i = 0; i < row.count; ++i) {
      TEST_ASSERT_DOUBLE_WITHIN(6e-6, row.amplitude[i], prototype.train.impulses[i].amplitude);
      TEST_ASSERT_DOUBLE_WITHIN(6e-6, row.time[i], prototype.train.impulses[i].time * root);
    }
    for (uint32_t k = 0; k < prototype.zero_count; ++k) {
      TEST_ASSERT_DOUBLE_WITHIN(6e-5, row.zero[k], prototype.zeros[k].ratio);
    }
  }
}

TEST(undamped_extra_insensitive_trains_are_the_closed_forms) {
  const double v = kTolerance;
  const double one[] = {(1.0 + v) / 4.0, (1.0 - v) / 2.0, (1.0 + v) / 4.0};
  check_undamped(ShaperKind::kEi, one, 3);
  const double x = math::cbrt(v * v * (math::sqrt(1.0 - v * v) + 1.0));
  const double outer = (3.0 * x * x + 2.0 * x + 3.0 * v * v) / (16.0 * x);
  const double two[] = {outer, 0.5 - outer, 0.5 - outer, outer};
  check_undamped(ShaperKind::kEi2, two, 4);
  const double first = (1.0 + 3.0 * v + 2.0 * math::sqrt(2.0 * (v * v + v))) / 16.0;
  const double second = (1.0 - v) / 4.0;
  const double three[] = {first, second, 1.0 - 2.0 * (first + second), second, first};
  check_undamped(ShaperKind::kEi3, three, 5);
}

// Park's construction: lower, not an error.
TEST(upper_humps_of_a_convolution_are_lower_than_the_tolerance) {
  struct Row {
    ShaperKind kind;
    double damping_ratio;
    double height;
    double digit;
  };
  constexpr Row kRows[] = {{ShaperKind::kCv2, 0.0, 0.043, 5e-4},
                           {ShaperKind::kCv3, 0.0, 0.015, 5e-4},
                           {ShaperKind::kCv3, 0.1, 0.0029, 5e-5}};
  for (const Row& row : kRows) {
    const Prototype prototype = made(row.kind, row.damping_ratio);
    const uint32_t top = prototype.zero_count - 1;
    const Extreme hump = extreme_between(prototype.train, row.damping_ratio, prototype.zeros[top - 1].ratio,
                                         prototype.zeros[top].ratio, 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(row.digit, row.height, static_cast<double>(hump.residual));
  }
}

TEST(three_humps_of_five_percent_do_not_exist_at_a_damping_of_thirty) {
  Prototype prototype{};
  TEST_ASSERT_REFUSED(
      kAboveMaximum, kTolerance,
      make_prototype(ShaperSpec{ShaperKind::kEi3, Mode{1.0, 0.3}, 0.05, kDefaultSpacing, nullptr}, prototype));
}

TEST(three_impulses_are_zv_at_a_quarter_and_zvd_at_a_half) {
  for (int n = 0; n <= 3; ++n) {
    const double zeta = 0.1 * n;
    const double root = math::sqrt(1.0 - zeta * zeta);
    const double k = math::exp(-math::kPi * zeta / root);
    Prototype prototype = made(ShaperKind::kMzv, zeta, 0.25);
    const double zv[] = {1.0 / (1.0 + k), 0.0, k / (1.0 + k)};
    for (int i = 0; i < 3; ++i) {
      TEST_ASSERT_DOUBLE_WITHIN(1e-15, zv[i], prototype.train.impulses[i].amplitude);
      TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.25 * i / root, prototype.train.impulses[i].time);
    }
    prototype = made(ShaperKind::kMzv, zeta, 0.5);
    const double square = (1.0 + k) * (1.0 + k);
    const double zvd[] = {1.0 / square, 2.0 * k / square, k * k / square};
    for (int i = 0; i < 3; ++i) {
      TEST_ASSERT_DOUBLE_WITHIN(1e-15, zvd[i], prototype.train.impulses[i].amplitude);
      TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.5 * i / root, prototype.train.impulses[i].time);
    }
  }
}

TEST(between_them_length_grows_steadily_and_the_mode_is_left_still) {
  for (int n = 0; n <= 2; ++n) {
    const double zeta = 0.15 * n;
    const double root = math::sqrt(1.0 - zeta * zeta);
    for (int i = 0; i <= 20; ++i) {
      const double spacing = 0.25 + 0.25 * i / 20.0;
      const Prototype prototype = made(ShaperKind::kMzv, zeta, spacing);
      TEST_ASSERT_DOUBLE_RELATIVE(1e-13, 2.0 * spacing / root, prototype.train.impulses[2].time);
      TEST_ASSERT_AT_MOST_DOUBLE(1e-14, residual_ratio(prototype.train, 1, zeta));
      for (int k = 0; k < 3; ++k) TEST_ASSERT_AT_LEAST_DOUBLE(0.0, prototype.train.impulses[k].amplitude);
    }
  }
}

TEST(unity_magnitude_impulses_are_plus_minus_plus_and_leave_the_mode_still) {
  for (int n = 0; n <= 30; ++n) {
    const double zeta = 0.01 * n;
    TEST_INFO("damping", zeta);
    const Prototype prototype = made(ShaperKind::kUmZv, zeta);
    TEST_ASSERT_EQUAL_UINT32(3, prototype.train.impulse_count);
    for (int i = 0; i < 3; ++i) {
      TEST_ASSERT_DOUBLE_WITHIN(0.0, i == 1 ? -1.0 : 1.0, prototype.train.impulses[i].amplitude);
    }
    TEST_ASSERT_AT_MOST_DOUBLE(1e-14, residual_ratio(prototype.train, 1, zeta));
    if (n > 0) continue;
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0 / 6.0, prototype.train.impulses[1].time);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0 / 3.0, prototype.train.impulses[2].time);
  }
}
