// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/small_lp.hpp"

#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

constexpr double kPenalty = 100.0;

// x in [0, upper]^2, rows a x <= b: what the vertices and a fine walk along the edges say is the least cost.
struct Plane {
  static constexpr int kRows = 4;
  double cost[2];
  double upper[2];
  double row[kRows][2];
  double right[kRows];

  bool allows(double x, double y) const {
    constexpr double kRounding = 1e-9;
    if (x < -kRounding || y < -kRounding || x > upper[0] + kRounding || y > upper[1] + kRounding) return false;
    for (int i = 0; i < kRows; ++i) {
      if (row[i][0] * x + row[i][1] * y > right[i] + kRounding) return false;
    }
    return true;
  }

  // Every vertex is where two of the eight lines meet.
  double least() const {
    const double lines[kRows + 4][3] = {{row[0][0], row[0][1], right[0]},
                                        {row[1][0], row[1][1], right[1]},
                                        {row[2][0], row[2][1], right[2]},
                                        {row[3][0], row[3][1], right[3]},
                                        {1.0, 0.0, 0.0},
                                        {0.0, 1.0, 0.0},
                                        {1.0, 0.0, upper[0]},
                                        {0.0, 1.0, upper[1]}};
    double best = 1e300;
    for (const auto& a : lines) {
      for (const auto& b : lines) {
        const double whole = a[0] * b[1] - a[1] * b[0];
        if (whole < 1e-9 && whole > -1e-9) continue;
        const double x = (a[2] * b[1] - a[1] * b[2]) / whole;
        const double y = (a[0] * b[2] - a[2] * b[0]) / whole;
        const double value = cost[0] * x + cost[1] * y;
        if (allows(x, y) && value < best) best = value;
      }
    }
    return best;
  }
};

}  // namespace

TEST(it_finds_the_best_vertex_of_random_planes) {
  const uint64_t seed = 5;
  TEST_INFO("seed", seed);
  Random random(seed);
  int possible = 0;
  for (int i = 0; i < 2000; ++i) {
    TEST_INFO("case", i);
    Plane plane{};
    SmallLp lp(2, kPenalty);
    for (int k = 0; k < 2; ++k) {
      plane.cost[k] = random.between(-1.0, 1.0);
      plane.upper[k] = random.between(0.1, 2.0);
      lp.set(static_cast<size_t>(k), plane.cost[k], plane.upper[k]);
    }
    for (int r = 0; r < Plane::kRows; ++r) {
      plane.row[r][0] = random.between(-1.0, 1.0);
      plane.row[r][1] = random.between(-1.0, 1.0);
      plane.right[r] = random.between(-0.3, 1.0);
      lp.add_row(plane.row[r], plane.right[r], false);
    }
    double x[2];
    TEST_ASSERT_TRUE(lp.solve(x));
    const double least = plane.least();
    if (least > 1e200) continue;
    ++possible;
    TEST_ASSERT_TRUE(plane.allows(x[0], x[1]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, least, plane.cost[0] * x[0] + plane.cost[1] * x[1]);
  }
  TEST_ASSERT_AT_LEAST_INT64(1000, possible);
}

// Weights of a mean: the sum is one, the cheapest takes it up to its bound, then the next.
TEST(equalities_hold_and_bounds_are_used_in_the_order_of_their_costs) {
  constexpr size_t kCount = SmallLp::kMaxVariables;
  SmallLp lp(kCount, kPenalty);
  double ones[kCount];
  for (size_t i = 0; i < kCount; ++i) {
    ones[i] = 1.0;
    lp.set(i, 1.0 + 0.1 * static_cast<double>(i), 0.3);
  }
  lp.add_row(ones, 1.0, true);
  double x[kCount];
  TEST_ASSERT_TRUE(lp.solve(x));
  const double expected[] = {0.3, 0.3, 0.3, 0.1};
  for (size_t i = 0; i < kCount; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-12, i < 4 ? expected[i] : 0.0, x[i]);
}

TEST(a_row_that_cannot_be_kept_is_broken_as_little_as_the_bounds_allow) {
  constexpr bool kEqualities[] = {true, false};
  for (const bool equality : kEqualities) {
    SmallLp lp(2, kPenalty);
    lp.set(0, 1.0, 0.5);
    lp.set(1, 1.0, 0.25);
    const double row[] = {-1.0, -2.0};
    lp.add_row(row, -3.0, equality);
    double x[2];
    TEST_ASSERT_TRUE(lp.solve(x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5, x[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25, x[1]);
  }
}

TEST(rows_beyond_its_room_are_left_out) {
  SmallLp lp(1, kPenalty);
  lp.set(0, -1.0, 2.0);
  const double row[] = {1.0};
  for (size_t i = 0; i < SmallLp::kMaxRows; ++i) lp.add_row(row, 1.5, false);
  lp.add_row(row, 1.0, false);
  double x[1];
  TEST_ASSERT_TRUE(lp.solve(x));
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.5, x[0]);
}
