// SPDX-License-Identifier: Apache-2.0
// What the shapers promise in continuous time, at random tolerances and damping.
#include <algorithm>

#include "shaper/shaping/prototype.hpp"
#include "tests/shaper/shaping/residual_oracle.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::extreme_between;
using stillpoint::testing::Random;
using stillpoint::testing::residual_ratio;

namespace {

Status make(ShaperKind kind, double damping_ratio, double tolerance, Prototype& prototype) {
  const ShaperSpec spec{kind, Mode{1.0, damping_ratio}, tolerance, 0.0, nullptr};
  return make_prototype(spec.with_defaults(), prototype);
}

bool is_extra_insensitive(ShaperKind kind) {
  return kind == ShaperKind::kEi || kind == ShaperKind::kEi2 || kind == ShaperKind::kEi3;
}

constexpr ShaperKind kHumped[] = {ShaperKind::kEi,  ShaperKind::kEi2, ShaperKind::kEi3, ShaperKind::kCv1,
                                  ShaperKind::kCv2, ShaperKind::kCv3, ShaperKind::kCv4};

void check_impulses(const Prototype& prototype) {
  for (uint32_t p = 0; p < prototype.train.part_count; ++p) {
    const Cascade::Part& part = prototype.train.parts[p];
    double sum = 0.0;
    double last = -1.0;
    for (uint32_t i = part.first; i < part.first + part.count; ++i) {
      const Impulse& impulse = prototype.train.impulses[i];
      sum += impulse.amplitude;
      TEST_ASSERT_TRUE(impulse.time > last);
      TEST_ASSERT_TRUE(impulse.amplitude > 0.0);
      last = impulse.time;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, sum);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, prototype.train.impulses[part.first].time);
  }
}

// Returns the largest miss of a hump that is promised, over the tolerance.
double check_humps(ShaperKind kind, const Prototype& prototype, double damping_ratio, double tolerance) {
  const uint32_t humps = humps_of(kind);
  double worst = 0.0;
  for (uint32_t j = 0; j < humps; ++j) {
    const double low = prototype.zeros[j].ratio;
    const double high = prototype.zeros[j + 1].ratio;
    TEST_ASSERT_TRUE(low < high);
    const auto height = static_cast<double>(extreme_between(prototype.train, damping_ratio, low, high, 1).residual);
    if (is_extra_insensitive(kind) || 2 * j + 1 <= humps) {
      worst = std::max(worst, std::abs(height / tolerance - 1.0));
    } else {
      TEST_ASSERT_AT_MOST_DOUBLE(tolerance * (1.0 + 1e-9), height);
    }
  }
  return worst;
}

double largest_at_zeros(const Prototype& prototype, double damping_ratio) {
  double worst = 0.0;
  for (uint32_t k = 0; k < prototype.zero_count; ++k) {
    const auto left = static_cast<double>(residual_ratio(prototype.train, prototype.zeros[k].ratio, damping_ratio));
    worst = std::max(worst, left);
  }
  return worst;
}

}  // namespace

TEST_HOST(random_band_shapers_have_the_humps_and_zeros_they_promise) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  Random random(seed);
  double worst_hump = 0.0;
  double worst_zero = 0.0;
  int refused[kShaperKinds] = {};
  for (int n = 0; n < 700; ++n) {
    const ShaperKind kind = kHumped[n % 7];
    const double zeta = n % 5 == 0 ? 0.0 : random.between(0.0, kMaxDampingRatio);
    const double tolerance = n % 2 == 0 ? random.between(kMinTolerance, kMaxTolerance)
                                        : kMinTolerance * std::pow(kMaxTolerance / kMinTolerance, random.unit());
    TEST_INFO("kind", static_cast<uint32_t>(kind));
    TEST_INFO("damping", zeta);
    TEST_INFO("tolerance", tolerance);
    Prototype prototype{};
    const Status status = make(kind, zeta, tolerance, prototype);
    if (!status.ok()) {
      TEST_ASSERT_REFUSED(kAboveMaximum, kTolerance, status);
      ++refused[static_cast<uint32_t>(kind)];
      continue;
    }
    TEST_ASSERT_EQUAL_UINT32(humps_of(kind) + 1, prototype.zero_count);
    check_impulses(prototype);
    worst_hump = std::max(worst_hump, check_humps(kind, prototype, zeta, tolerance));
    worst_zero = std::max(worst_zero, largest_at_zeros(prototype, zeta));
    if (prototype.zero_count % 2 == 1) {
      TEST_ASSERT_DOUBLE_WITHIN(0.0, 1.0, prototype.zeros[prototype.zero_count / 2].ratio);
    } else if (is_extra_insensitive(kind)) {
      const auto at_mode = residual_ratio(prototype.train, 1.0L, zeta);
      TEST_ASSERT_DOUBLE_RELATIVE(1e-9, tolerance, static_cast<double>(at_mode));
    }
  }
  MESSAGE("worst hump ", worst_hump, " of the tolerance, worst zero ", worst_zero);
  TEST_ASSERT_AT_MOST_DOUBLE(1e-6, worst_hump);  // asked for is 1e-4
  TEST_ASSERT_AT_MOST_DOUBLE(1e-9, worst_zero);
  for (const ShaperKind kind : kHumped)
    MESSAGE(doctest::String(text(kind)), ": refused ", refused[static_cast<uint32_t>(kind)]);
  TEST_ASSERT_AT_MOST_INT64(0, refused[static_cast<uint32_t>(ShaperKind::kEi)]);
}

TEST_HOST(a_refused_tolerance_names_one_that_is_accepted_and_nearly_the_largest) {
  const uint64_t seed = 41;
  TEST_INFO("seed", seed);
  Random random(seed);
  int refused = 0;
  double worst = 1.0;
  for (int n = 0; n < 280; ++n) {
    const ShaperKind kind = kHumped[n % 7];
    const double zeta = random.between(0.1, kMaxDampingRatio);
    TEST_INFO("kind", static_cast<uint32_t>(kind));
    TEST_INFO("damping", zeta);
    Prototype prototype{};
    const Status status = make(kind, zeta, kMaxTolerance, prototype);
    if (status.ok()) continue;
    ++refused;
    TEST_ASSERT_REFUSED(kAboveMaximum, kTolerance, status);
    TEST_ASSERT_AT_LEAST_DOUBLE(kMinTolerance, status.accepted);
    TEST_ASSERT_OK(make(kind, zeta, status.accepted, prototype));
    TEST_ASSERT_AT_MOST_DOUBLE(1e-6, check_humps(kind, prototype, zeta, status.accepted));
    double largest = status.accepted;
    for (const double factor : {1.01, 1.03, 1.06, 1.1, 1.15, 1.3, 1.6}) {
      const double probe = factor * status.accepted;
      if (probe <= kMaxTolerance && make(kind, zeta, probe, prototype).ok()) largest = probe;
    }
    worst = std::min(worst, status.accepted / largest);
    TEST_ASSERT_AT_LEAST_DOUBLE(0.9, status.accepted / largest);
  }
  MESSAGE(refused, " of 280 refused; the value named is at least ", worst, " of the largest");
  TEST_ASSERT_AT_LEAST_INT64(50, refused);
  TEST_ASSERT_AT_MOST_INT64(230, refused);
}
